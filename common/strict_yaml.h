// Strict reading of YAML from outside the program. Only this module uses yaml-cpp.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/input_error.h"

namespace fjr {

inline constexpr std::uintmax_t kMaxYamlBytes = 1 << 20;

// "3.4 rad"; the unit "1" is left out. Shortest digits that read back to the same value.
std::string with_unit(double value, std::string_view unit);

// Returns `text` from outside in a form for error messages: quoted, printable, and truncated to a readable length.
std::string shown(std::string_view text);

// Returns `text` as a quoted scalar that is read back as the same text.
std::string quoted_flow(std::string_view text);

// Returns the text of a document. If it is longer than kMaxYamlBytes, returns only its beginning, which parse()
// refuses. Throws InputError if it cannot be read.
std::string read_document(const std::filesystem::path& file);
std::string read_document(std::istream& in, const std::string& source);

// One value of a document together with its position, for precise error messages.
// All reading functions throw InputError with source, path of the field ("goal.q[1]") and problem. Refused while
// parsing: syntax errors (with their line), duplicate keys, keys that are not text, anchors and aliases, tags, several
// documents, deep nesting, and documents too large to have been meant. A node keeps its document alive.
class YamlNode {
 public:
  static YamlNode parse(const std::string& text, const std::string& source);
  static YamlNode load(const std::filesystem::path& file);  // source: the name as given

  const std::string& source() const;
  const std::string& field() const { return field_; }

  bool is_map() const;
  bool is_list() const;
  bool is_scalar() const;  // not null
  bool is_null() const;
  bool is_number() const;                  // number() would accept it: finite and not quoted
  bool is_nan_or_infinite() const;         // spelt nan, inf or infinity, as JSON writers of Python do it
  bool says(std::string_view word) const;  // whether it is the scalar `word`
  std::string kind() const;                // "a list of 3", for messages

  const std::vector<std::string>& keys() const;  // of a map, in their order

  // For maps. `find` returns nothing for an absent key; `at` throws "missing".
  void allow_keys(const std::vector<std::string_view>& allowed) const;
  std::optional<YamlNode> find(std::string_view key) const;
  YamlNode at(std::string_view key) const;

  std::vector<YamlNode> items() const;  // of a list

  double number(std::string_view unit) const;  // finite
  std::uint64_t whole_number(std::uint64_t least = 0, std::uint64_t most = UINT64_MAX) const;
  std::array<double, 2> pair(std::string_view unit) const;               // a list of two finite numbers
  const std::string& text() const;                                       // not empty
  std::size_t one_of(const std::vector<std::string_view>& words) const;  // index of the word that it is
  bool truth() const;                                                    // true or false

  std::string flow() const;  // as one line of YAML that reads back as the same: "{q: [0.3, 0.2]}"

  [[noreturn]] void fail(const std::string& problem) const;
  // The same for element `index` of this list: "goal.q[1]".
  [[noreturn]] void fail_at(std::size_t index, const std::string& problem) const;

 private:
  struct Tree;
  struct Document;
  class Builder;

  YamlNode(std::shared_ptr<const Document> document, const Tree* tree, std::string field);
  YamlNode child(const Tree& tree, std::string field) const;
  static std::string flow(const Tree& tree);

  std::shared_ptr<const Document> document_;
  const Tree* tree_;
  std::string field_;
};

}  // namespace fjr
