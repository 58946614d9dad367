#include "common/strict_yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include "common/spelling.h"

namespace fjr {
namespace {

constexpr std::size_t kMaxDepth = 16, kMaxNodes = 20000, kMaxShown = 40;

std::string line_of(const YAML::Mark& mark) { return mark.is_null() ? "" : fmt::format("line {}", mark.line + 1); }

std::string unit_note(std::string_view unit) { return unit == "1" ? "" : fmt::format(" ({})", unit); }

// A leading plus sign is YAML but not from_chars.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

// Parses all of `text` as one number.
template <class Number>
std::errc read_whole_text(std::string_view text, Number& value) {
  const std::string_view digits = without_plus(text);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc()) return error;
  return end == digits.data() + digits.size() ? std::errc() : std::errc::invalid_argument;
}

// Plain text that stays the same within a flow map or list.
bool stays_plain(std::string_view text) {
  const auto harmless = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '+'; };
  const std::string_view rest = text.substr(std::min<std::size_t>(1, text.size()));
  return !text.empty() && (harmless(text[0]) || (text[0] == '-' && !rest.empty())) &&
         std::all_of(rest.begin(), rest.end(), [&](char c) { return harmless(c) || c == '-'; });
}

}  // namespace

struct YamlNode::Tree {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  std::string scalar;
  bool plain = true;              // not quoted, so it may be a number
  std::vector<std::string> keys;  // of a map, in order, beside its children
  std::vector<Tree> children;
};

struct YamlNode::Document {
  std::string source;
  Tree root;
};

// Builds the tree from the parser's events, and refuses features of YAML that our files do not need.
class YamlNode::Builder : public YAML::EventHandler {
 public:
  explicit Builder(std::string source) : source_(std::move(source)) {}

  Tree take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (expects_key()) refuse(mark, "a key must be text");
    add(mark, Tree{});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark, "aliases (*name) are not allowed"); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override {
    refuse(mark, "anchors (&name) are not allowed");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& value) override {
    refuse_tag(mark, tag);
    if (expects_key()) {
      if (!stack_.back().seen.insert(value).second) refuse(mark, fmt::format("key {} is given twice", shown(value)));
      stack_.back().tree.keys.push_back(value);
      return;
    }
    Tree scalar;
    scalar.kind = Tree::Kind::kScalar;
    scalar.scalar = value;
    scalar.plain = tag != "!";
    add(mark, std::move(scalar));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, Tree::Kind::kList);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, tag, Tree::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    Tree tree;
    YAML::Mark mark;
    std::set<std::string> seen;
  };

  bool expects_key() const {
    if (stack_.empty() || stack_.back().tree.kind != Tree::Kind::kMap) return false;
    return stack_.back().tree.keys.size() == stack_.back().tree.children.size();
  }

  void open(const YAML::Mark& mark, const std::string& tag, Tree::Kind kind) {
    refuse_tag(mark, tag);
    if (expects_key()) refuse(mark, "a key must be text");
    if (stack_.size() >= kMaxDepth) refuse(mark, fmt::format("nested deeper than {} levels", kMaxDepth));
    stack_.push_back({});
    stack_.back().tree.kind = kind;
    stack_.back().mark = mark;
  }

  void close() {
    Open done = std::move(stack_.back());
    stack_.pop_back();
    add(done.mark, std::move(done.tree));
  }

  void add(const YAML::Mark& mark, Tree tree) {
    if (++nodes_ > kMaxNodes) refuse(mark, fmt::format("more than {} values", kMaxNodes));
    if (stack_.empty()) {
      root_ = std::move(tree);
    } else {
      stack_.back().tree.children.push_back(std::move(tree));
    }
  }

  // "?" is a plain scalar, "!" a quoted one.
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!") refuse(mark, "tags (!name) are not allowed");
  }

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& problem) const {
    throw InputError(source_, line_of(mark), problem);
  }

  std::string source_;
  Tree root_;
  std::vector<Open> stack_;
  std::size_t nodes_ = 0;
};

std::string with_unit(double value, std::string_view unit) {
  return unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

std::string shown(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, kMaxShown)) {
    const bool printable = c >= ' ' && c <= '~' && c != '"' && c != '\\';
    result += printable ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return result + (text.size() > kMaxShown ? "...\"" : "\"");
}

std::string quoted_flow(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool escaped = byte < ' ' || c == '"' || c == '\\' || byte == 0x7F;
    quoted += escaped ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return quoted + '"';
}

YamlNode YamlNode::parse(const std::string& text, const std::string& source) {
  if (text.size() > kMaxYamlBytes) throw InputError(source, "", fmt::format("larger than {} bytes", kMaxYamlBytes));
  if (text.find('\0') != std::string::npos) throw InputError(source, "", "is not a text file: it contains zero bytes");
  std::istringstream in(text);
  Builder builder(source);
  try {
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(builder)) throw InputError(source, "", "empty");
    Builder rest(source);
    if (parser.HandleNextDocument(rest)) throw InputError(source, "", "holds more than one YAML document");
  } catch (const YAML::Exception& e) {
    throw InputError(source, line_of(e.mark), "not valid YAML: " + e.msg);
  }
  auto document = std::make_shared<Document>();
  document->source = source;
  document->root = builder.take();
  const Tree* root = &document->root;
  return YamlNode(std::move(document), root, "");
}

// One byte more than allowed is read, so that a file that grows meanwhile is noticed too.
std::string read_document(std::istream& in, const std::string& source) {
  std::string text(kMaxYamlBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw InputError(source, "", "cannot be read");
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

std::string read_document(const std::filesystem::path& file) {
  const std::string source = file.string();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(source, "", "no such file");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(source, "", "not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(source, "", "cannot be opened");
  return read_document(in, source);
}

YamlNode YamlNode::load(const std::filesystem::path& file) { return parse(read_document(file), file.string()); }

YamlNode::YamlNode(std::shared_ptr<const Document> document, const Tree* tree, std::string field)
    : document_(std::move(document)), tree_(tree), field_(std::move(field)) {}

YamlNode YamlNode::child(const Tree& tree, std::string field) const {
  return YamlNode(document_, &tree, std::move(field));
}

const std::string& YamlNode::source() const { return document_->source; }

bool YamlNode::is_map() const { return tree_->kind == Tree::Kind::kMap; }
bool YamlNode::is_list() const { return tree_->kind == Tree::Kind::kList; }
bool YamlNode::is_scalar() const { return tree_->kind == Tree::Kind::kScalar; }
bool YamlNode::is_null() const { return tree_->kind == Tree::Kind::kNull; }
bool YamlNode::is_number() const {
  double value = 0;
  return is_scalar() && tree_->plain && read_whole_text(tree_->scalar, value) == std::errc() && std::isfinite(value);
}
bool YamlNode::is_nan_or_infinite() const {
  double value = 0;
  return is_scalar() && tree_->plain && read_whole_text(tree_->scalar, value) == std::errc() && !std::isfinite(value);
}
bool YamlNode::says(std::string_view word) const { return is_scalar() && tree_->scalar == word; }

std::string YamlNode::kind() const {
  if (is_map()) return "a map";
  if (is_list()) return fmt::format("a list of {}", tree_->children.size());
  if (is_null()) return "empty";
  return is_number() ? "the number " + tree_->scalar : "the text " + shown(tree_->scalar);
}

void YamlNode::allow_keys(const std::vector<std::string_view>& allowed) const {
  if (!is_map()) fail(fmt::format("must be a map with the keys {}, not {}", fmt::join(allowed, ", "), kind()));
  for (const std::string& key : tree_->keys) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      fail(fmt::format("unknown key {}; allowed: {}{}", shown(key), fmt::join(allowed, ", "),
                       did_you_mean(key, allowed)));
    }
  }
}

std::size_t YamlNode::one_of(const std::vector<std::string_view>& words) const {
  const auto found = std::find(words.begin(), words.end(), text());
  if (found == words.end()) {
    fail(fmt::format("{} is not one of {}{}", shown(text()), fmt::join(words, ", "), did_you_mean(text(), words)));
  }
  return static_cast<std::size_t>(found - words.begin());
}

const std::vector<std::string>& YamlNode::keys() const {
  if (!is_map()) fail(fmt::format("must be a map, not {}", kind()));
  return tree_->keys;
}

std::optional<YamlNode> YamlNode::find(std::string_view key) const {
  if (!is_map()) fail(fmt::format("must be a map, not {}", kind()));
  const auto found = std::find(tree_->keys.begin(), tree_->keys.end(), key);
  if (found == tree_->keys.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(found - tree_->keys.begin());
  return child(tree_->children[index], field_.empty() ? std::string(key) : fmt::format("{}.{}", field_, key));
}

YamlNode YamlNode::at(std::string_view key) const {
  const std::optional<YamlNode> found = find(key);
  if (!found)
    throw InputError(source(), field_.empty() ? std::string(key) : fmt::format("{}.{}", field_, key), "missing");
  return *found;
}

std::vector<YamlNode> YamlNode::items() const {
  if (!is_list()) fail(fmt::format("must be a list, not {}", kind()));
  std::vector<YamlNode> result;
  result.reserve(tree_->children.size());
  for (std::size_t i = 0; i < tree_->children.size(); ++i) {
    result.push_back(child(tree_->children[i], fmt::format("{}[{}]", field_, i)));
  }
  return result;
}

double YamlNode::number(std::string_view unit) const {
  if (!is_scalar() || !tree_->plain) fail(fmt::format("must be a number{}, not {}", unit_note(unit), kind()));
  double value = 0;
  const std::errc error = read_whole_text(tree_->scalar, value);
  if (error == std::errc::result_out_of_range) fail(fmt::format("{} is out of range", shown(tree_->scalar)));
  if (error != std::errc() || !std::isfinite(value)) {
    fail(fmt::format("{} is not a finite number{}", shown(tree_->scalar), unit_note(unit)));
  }
  return value;
}

std::uint64_t YamlNode::whole_number(std::uint64_t least, std::uint64_t most) const {
  if (!is_scalar() || !tree_->plain) fail(fmt::format("must be a whole number, not {}", kind()));
  std::uint64_t value = 0;
  if (read_whole_text(tree_->scalar, value) != std::errc()) {
    fail(fmt::format("{} is not a whole number from {} to {}", shown(tree_->scalar), least, most));
  }
  if (value < least || value > most) fail(fmt::format("{} is outside [{}, {}]", value, least, most));
  return value;
}

std::array<double, 2> YamlNode::pair(std::string_view unit) const {
  if (!is_list() || tree_->children.size() != 2) {
    fail(fmt::format("must be two numbers{}, [joint 1, joint 2], not {}", unit_note(unit), kind()));
  }
  const std::vector<YamlNode> both = items();
  return {both[0].number(unit), both[1].number(unit)};
}

const std::string& YamlNode::text() const {
  if (!is_scalar()) fail(fmt::format("must be text, not {}", kind()));
  if (tree_->scalar.empty()) fail("must not be empty");
  return tree_->scalar;
}

std::string YamlNode::flow() const { return flow(*tree_); }

std::string YamlNode::flow(const Tree& tree) {
  if (tree.kind == Tree::Kind::kNull) return "null";
  if (tree.kind == Tree::Kind::kScalar) {
    return tree.plain && stays_plain(tree.scalar) ? tree.scalar : quoted_flow(tree.scalar);
  }
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < tree.children.size(); ++i) {
    const std::string key = tree.kind == Tree::Kind::kMap ? quoted_flow(tree.keys[i]) + ": " : "";
    parts.push_back(key + flow(tree.children[i]));
  }
  const std::string inside = fmt::format("{}", fmt::join(parts, ", "));
  return tree.kind == Tree::Kind::kMap ? "{" + inside + "}" : "[" + inside + "]";
}

bool YamlNode::truth() const {
  if (!says("true") && !says("false")) fail(shown(text()) + " is neither true nor false");
  return says("true");
}

void YamlNode::fail(const std::string& problem) const { throw InputError(source(), field_, problem); }

void YamlNode::fail_at(std::size_t index, const std::string& problem) const {
  throw InputError(source(), fmt::format("{}[{}]", field_, index), problem);
}

}  // namespace fjr
