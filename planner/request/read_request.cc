// Reads a document as a Request.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <variant>

#include "common/spelling.h"
#include "planner/request/request.h"
#include "planner/request/words.h"

namespace fjr {
namespace {

// Overloads for each form of value; unit: of its numbers.
template <class T>
void read(const YamlNode& node, const char* unit, std::optional<T>& value);
template <class T>
void read(const YamlNode& node, const char* unit, std::vector<T>& list);
template <Keyed R>
void read(const YamlNode& node, const char* unit, R& r);
template <class Kind, class Variant>
void read(const YamlNode& node, const char* unit, OneOf<Kind, Variant>& member);
void read(const YamlNode& node, const char* unit, std::optional<RequestedStart>& start);
void read(const YamlNode& node, const char* unit, RequestedGoal& goal);
void read(const YamlNode& node, const char* unit, RequestedDuration& duration);
void read(const YamlNode& node, const char* unit, RequestedTip& tip);

void read(const YamlNode& node, const char* unit, double& value) { value = node.number(unit); }
void read(const YamlNode& node, const char* unit, Joints<double>& value) { value = node.pair(unit); }
void read(const YamlNode& node, const char*, std::uint64_t& value) { value = node.whole_number(); }
void read(const YamlNode& node, const char*, std::string& value) { value = node.text(); }

void read(const YamlNode& node, const char*, bool& value) {
  if (!node.says("true") && !node.says("false")) node.fail("must be true or false, not " + node.kind());
  value = node.says("true");
}

template <Worded Choice>
void read(const YamlNode& node, const char*, Choice& value) {
  std::vector<std::string_view> words;
  for (const auto& [word, choice] : kWords<Choice>) words.push_back(word);
  value = kWords<Choice>[node.one_of(words)].second;
}

// Reads a number where the word `free` was possible too.
double number_beside_free(const YamlNode& node, const char* unit) {
  const bool is_word = node.is_scalar() && std::isalpha(static_cast<unsigned char>(node.text()[0])) != 0;
  if (is_word && !node.is_nan_or_infinite()) {
    node.fail(
        fmt::format("must be a number ({}) or free, not {}{}", unit, node.kind(), did_you_mean(node.text(), {"free"})));
  }
  return node.number(unit);
}

void read(const YamlNode& node, const char* unit, AnglesOrFree& angles) {
  const std::vector<YamlNode> items = node.is_list() ? node.items() : std::vector<YamlNode>{};
  const auto is_free = [](const YamlNode& item) { return item.says("free"); };
  const auto is_number = [](const YamlNode& item) { return item.is_number(); };
  if (items.size() != kJoints || std::all_of(items.begin(), items.end(), is_number)) {
    const Joints<double> both = node.pair(unit);
    std::copy(both.begin(), both.end(), angles.begin());
    return;
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!is_free(items[j])) angles[j] = number_beside_free(items[j], unit);
  }
}

void read(const YamlNode& node, const char* unit, VelocityOrFree& velocity) {
  if (node.is_scalar() && !node.says("free")) {
    node.fail(fmt::format("must be two numbers ({}), [joint 1, joint 2], or free, not {}{}", unit, node.kind(),
                          did_you_mean(node.text(), {"free"})));
  }
  velocity = node.says("free") ? VelocityOrFree{AnyVelocity{}} : node.pair(unit);
}

void read(const YamlNode& node, const char* unit, TipBox& box) {
  const std::vector<YamlNode> corners = node.items();
  if (corners.size() != 2) node.fail("must be two corners: [[x, y], [x, y]]");
  box = {corners[0].pair(unit), corners[1].pair(unit)};
}

void read(const YamlNode& node, const char*, Payload& payload) { payload = read_payload(node); }

// Reads a limit. Infinity, as YAML, C++ and JSON write it, means no limit but the robot's: [10, .inf] limits joint 1
// alone.
double read_limit(const YamlNode& node, const char* unit) {
  for (const char* infinity : {".inf", "inf", "Infinity"}) {
    if (node.says(infinity)) return kNoLimit;
  }
  return node.number(unit);
}

Joints<double> read_limits(const YamlNode& node, const char* unit) {
  if (!node.is_list() || node.items().size() != kJoints) return node.pair(unit);
  return {read_limit(node.items()[0], unit), read_limit(node.items()[1], unit)};
}

void read(const YamlNode& node, const char*, Limits& limits) {
  std::vector<std::string_view> names;
  for (const QuantityInfo& quantity : Quantities::infos) names.emplace_back(quantity.name);
  node.allow_keys(names);
  for (const QuantityInfo& quantity : Quantities::infos) {
    const auto given = node.find(quantity.name);
    if (!given) continue;
    if (quantity.of_tip) limits.*quantity.of_tip = read_limit(*given, quantity.unit);
    if (quantity.per_joint) limits.*quantity.per_joint = read_limits(*given, quantity.unit);
  }
}

// `w`, or `{weight: w}`.
double weight_in(const YamlNode& term, const char* unit) {
  if (!term.is_map()) return term.number(unit);
  term.allow_keys({"weight"});
  return term.at("weight").number(unit);
}

void read(const YamlNode& node, const char* unit, RequestedObjective& objective) {
  if (node.is_scalar()) {
    std::vector<std::string_view> words;
    for (const auto& [word, preset] : kWords<Preset>) {
      words.push_back(word);
      if (!node.says(word)) continue;
      objective = preset;
      return;
    }
    node.fail(shown(node.text()) +
              " is not a preset (fastest, gentle, efficient); weights are given as {effort: 1, ...}" +
              did_you_mean(node.text(), words));
  }
  if (!node.is_map()) {
    node.fail("must be a preset (fastest, gentle, efficient) or weights {effort: 1, ...}, not " + node.kind());
  }
  std::vector<std::string_view> names;
  for (const TermInfo& term : Terms::infos) names.push_back(term.name);
  node.allow_keys(names);
  Weights& weights = objective.emplace<Weights>();
  for (const TermInfo& term : Terms::infos) {
    if (const auto weight = node.find(term.name)) weights.*term.weight = weight_in(*weight, unit);
  }
}

template <class T>
void read(const YamlNode& node, const char* unit, std::optional<T>& value) {
  read(node, unit, value.emplace());
}

template <class T>
void read(const YamlNode& node, const char* unit, std::vector<T>& list) {
  for (const YamlNode& item : node.items()) read(item, unit, list.emplace_back());
}

template <Keyed R>
void read_keys(const YamlNode& node, R& r) {
  std::vector<std::string_view> names;
  visit(r, [&](const Key& key, auto&) { names.emplace_back(key.name); });
  node.allow_keys(names);
  visit(r, [&](const Key& key, auto& member) {
    if (const auto given = key.required() ? node.at(key.name) : node.find(key.name)) read(*given, key.unit, member);
  });
}

template <Keyed R>
void read(const YamlNode& node, const char*, R& r) {
  read_keys(node, r);
}

void read(const YamlNode& node, const char*, RequestedTip& tip) {
  TipByKind kinds;
  read_keys(node, kinds);
  int given = 0;
  std::vector<const char*> names;
  visit(kinds, [&](const Key& key, auto& kind) {
    names.push_back(key.name);
    if (!kind) return;
    ++given;
    tip = *kind;
  });
  if (given != 1) node.fail(fmt::format("needs one of {}, and only one", fmt::join(names, ", ")));
}

void read(const YamlNode& node, const char* unit, RequestedDuration& duration) {
  if (node.says("free")) return;
  if (node.is_map()) {
    FreeDuration free;
    read_keys(node, free);
    const bool fixed = free.min && free.max && *free.min == *free.max;
    duration = fixed ? RequestedDuration{*free.min} : RequestedDuration{free};
    return;
  }
  if (!node.is_scalar()) node.fail("must be a number of seconds, free, or {min, max}");
  duration = number_beside_free(node, unit);
}

void read(const YamlNode& node, const char*, RequestedGoal& goal) {
  GoalByKey keys;
  read_keys(node, keys);
  if (const auto fault = fault_of(keys)) node.at(fault->key).fail(fault->sentence);  // at() tells what is missing
  goal = goal_of(keys);
}

// Refuses a path beside via points; `via: []` counts as none.
void refuse_another(const YamlNode& node, const RequestedWay& way) {
  const auto* via = std::get_if<std::vector<RequestedVia>>(&way);
  if (via == nullptr || !via->empty()) node.fail(kPathAndVia);
}

template <class Kind, class Variant>
void read(const YamlNode& node, const char* unit, OneOf<Kind, Variant>& member) {
  Kind kind{};
  read(node, unit, kind);
  refuse_another(node, member.all);
  member.all = std::move(kind);
}

// Reads the start. An empty one counts as left out.
void read(const YamlNode& node, const char*, std::optional<RequestedStart>& start) {
  if (node.is_null()) return;
  read_keys(node, start.emplace());
  if (node.find("q")) return;
  if (node.keys().empty()) return start.reset();
  (void)node.at("q");  // throws if it is missing
}

}  // namespace

Task read_task(const YamlNode& node) {
  Task task;
  std::vector<std::string_view> names;
  visit_constraints(task, [&](const char* key, auto&) { names.emplace_back(key); });
  node.allow_keys(names);
  visit_constraints(task, [&](const char* key, auto& member) {
    if (const auto given = node.find(key)) read(*given, "", member);
  });
  return task;
}

Request read_request(const YamlNode& root) {
  Request request;
  request.source = root.source();
  read_keys(root, request);
  return request;
}

Request read_request(const std::string& yaml, const std::string& source) {
  return read_request(YamlNode::parse(yaml, source));
}

}  // namespace fjr
