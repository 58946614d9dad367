#include "planner/request/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "planner/request/request.h"
#include "planner/request/words.h"

namespace fjr {
namespace {

using Lines = std::vector<KeyLine>;

// Lists the keys below a key, by the type of its value; most have none.
template <class T>
struct Below {
  static void list(const std::string& name, Lines& lines) {
    if constexpr (Keyed<T>) {
      T part{};
      visit(part, [&](const Key& key, auto& member) {
        const std::string own = name.empty() ? key.name : fmt::format("{}.{}", name, key.name);
        lines.push_back({own, key.unit, key.meaning, key.otherwise, key.allowed});
        Below<std::decay_t<decltype(member)>>::list(own, lines);
      });
    }
  }
};

template <class T>
struct Below<std::optional<T>> : Below<T> {};

template <class T>
struct Below<std::vector<T>> {
  static void list(const std::string& name, Lines& lines) { Below<T>::list(name + "[]", lines); }
};

template <class Kind, class Variant>
struct Below<OneOf<Kind, Variant>> : Below<Kind> {};

template <>
struct Below<RequestedGoal> : Below<GoalByKey> {};

template <>
struct Below<RequestedDuration> : Below<FreeDuration> {};

template <>
struct Below<RequestedTip> : Below<TipByKind> {};

template <>
struct Below<Limits> {
  static void list(const std::string& name, Lines& lines) {
    for (const QuantityInfo& limit : Quantities::infos) {
      lines.push_back({fmt::format("{}.{}", name, limit.name), limit.unit, limit.meaning,
                       limit.of_robot ? "the robot's" : "none", limit.of_robot ? "may only tighten" : "> 0"});
    }
  }
};

template <>
struct Below<RequestedObjective> {
  static void list(const std::string& name, Lines& lines) {
    for (const TermInfo& term : Terms::infos) {
      lines.push_back({fmt::format("{}.{}", name, term.name), fmt::format("per {}", term.unit),
                       fmt::format("weight of: {}", term.meaning), "0", "0 to 1e9"});
    }
  }
};

// Escapes vertical bars, which end a cell of the table.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

}  // namespace

std::vector<KeyLine> all_keys() {
  Lines lines;
  Below<Request>::list("", lines);
  return lines;
}

std::string unit_of_key(const std::string& path) {
  std::string key;  // with [] in place of indices: via[].q
  for (std::size_t i = 0; i < path.size(); ++i) {
    key += path[i];
    if (path[i] == '[') i = std::min(path.find(']', i), path.size()) - 1;
  }
  for (;; key.resize(key.size() - 2)) {  // the unit may belong to a list that contains the number
    for (const KeyLine& line : all_keys()) {
      if (line.name == key) return line.unit == "1" ? "" : line.unit;
    }
    if (!key.ends_with("[]")) return "";
  }
}

std::string keys_table() {
  std::string table = "| key | unit | is | left out | allowed |\n|---|---|---|---|---|\n";
  for (const KeyLine& line : all_keys()) {
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", line.name, cell(line.unit), cell(line.meaning),
                         cell(line.otherwise), cell(line.allowed));
  }
  return table;
}

}  // namespace fjr
