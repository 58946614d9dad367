#include "planner/results/explain_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/strict_yaml.h"
#include "planner/request/keys.h"
#include "planner/request/request.h"
#include "planner/request/words.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

// A key's path with indices: via[].time has the instances via[0].time, via[1].time, ...
struct Instance {
  std::string key;
  std::optional<YamlNode> node;  // empty if it is not given
  bool below_given = true;       // whether its parent is given, as a map
};

std::vector<Instance> step(const std::vector<Instance>& above, const std::string& word) {
  const bool items = word.ends_with("[]");
  const std::string name = items ? word.substr(0, word.size() - 2) : word;
  std::vector<Instance> below;
  for (const Instance& instance : above) {
    const std::string key = instance.key.empty() ? name : fmt::format("{}.{}", instance.key, name);
    const bool map = instance.node && instance.node->is_map();
    const std::optional<YamlNode> node = map ? instance.node->find(name) : std::nullopt;
    if (!items) {
      below.push_back({key, node, map});
    } else if (node && node->is_list()) {
      for (const YamlNode& item : node->items()) below.push_back({item.field(), item, true});
    }
  }
  return below;
}

std::vector<Instance> instances(const YamlNode& root, const std::string& name) {
  std::vector<Instance> found{{"", root, true}};
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find('.', from), name.size());
    found = step(found, name.substr(from, to - from));
    from = to + 1;
  }
  return found;
}

// via[0].time -> /via/0/time
Json::json_pointer pointer_to(const std::string& key) {
  std::string path = "/";
  for (const char c : key) {
    if (c != ']') path += c == '.' || c == '[' ? '/' : c;
  }
  return Json::json_pointer(path);
}

enum class Digits { kAll, kForPeople };

std::string text_of(const Json& value, Digits digits) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    const auto number = value.get<double>();
    return digits == Digits::kAll ? fmt::format("{}", number) : fmt::format("{:.6g}", number);
  }
  if (!value.is_array()) return value.dump();
  std::string items;
  for (const Json& item : value) {
    items += (items.empty() ? "" : ", ") + (item.is_null() ? std::string("free") : text_of(item, digits));
  }
  return "[" + items + "]";
}

// Removes the backticks and links of Markdown.
std::string plain(std::string text) {
  for (std::size_t from = text.find('['); from != std::string::npos; from = text.find('[', from + 1)) {
    const std::size_t middle = text.find("](", from), to = text.find(')', from);
    if (middle == std::string::npos || to == std::string::npos) break;
    text = text.substr(0, from) + text.substr(from + 1, middle - from - 1) + text.substr(to + 1);
  }
  std::erase(text, '`');
  return text;
}

// Returns the value of a key that is a single value in a request but becomes several when it is resolved.
std::optional<std::string> in_one_word(const std::string& key, const Problem& problem, const std::string& robot) {
  if (key == "robot") return robot;
  if (key == "duration") return problem.duration.fixed() ? fmt::format("{}", problem.duration.min) : "free";
  if (key == "objective") return std::string(word_of(default_preset(problem.duration)));
  if (key == "payload" && problem.robot.payload == Payload{}) return "0";
  if (key == "payload") {
    return fmt::format("{{mass: {}, inertia: {}}}", problem.robot.payload.mass, problem.robot.payload.inertia);
  }
  return std::nullopt;
}

// Limits are magnitudes, also of positions that are counted from the middle of an asymmetric range.
std::string note_on(const std::string& key, const Problem& problem) {
  const Joints<double>& middle = problem.limits.link_middle;
  if (key != "limits.link_position" || middle == Joints<double>{}) return "";
  return fmt::format("to either side of [{:.6g}, {:.6g}]", middle[0], middle[1]);
}

bool says_something(const std::string& value) { return !value.empty() && !value.starts_with(kNeeded); }

// Returns whether all keys of a part of the request are optional, as in `limits` and `objective`. Other missing parts
// have no defaults to show.
bool needs_nothing(const std::string& part, const std::vector<KeyLine>& lines) {
  return std::all_of(lines.begin(), lines.end(), [&](const KeyLine& line) {
    return !line.name.starts_with(part + ".") || (!line.otherwise.empty() && !line.otherwise.starts_with(kNeeded));
  });
}

// Returns whether a key applies only to goals of the tip, and the request has none of these.
bool is_for_another_goal(const std::string& key, const YamlNode& root) {
  const std::optional<YamlNode> goal = root.find("goal");
  return (key == "goal.elbow" || key == "goal.tip_velocity") && !(goal && goal->is_map() && goal->find("tip"));
}

}  // namespace

std::vector<UnderstoodKey> understood(const YamlNode& root, const Problem& problem, const std::string& robot) {
  const Json resolved = resolved_request_json(problem);
  std::vector<UnderstoodKey> keys;
  const std::vector<KeyLine> lines = all_keys();
  for (const KeyLine& line : lines) {
    const bool optional_part = needs_nothing(line.name.substr(0, line.name.rfind('.')), lines);
    for (const Instance& at : instances(root, line.name)) {
      if (is_for_another_goal(at.key, root)) continue;
      UnderstoodKey key{at.key, line.unit, "", "", note_on(at.key, problem), plain(line.meaning), at.node.has_value()};
      const Json::json_pointer pointer = pointer_to(at.key);
      const bool is_resolved = resolved.contains(pointer) && !resolved[pointer].is_null();
      if (at.node) {
        key.value = at.node->flow();
      } else if (const auto word = in_one_word(at.key, problem, robot)) {
        key.value = *word;
      } else if (is_resolved && !resolved[pointer].is_object() && !resolved[pointer].empty()) {
        key.value = text_of(resolved[pointer], Digits::kAll);
        key.shown = text_of(resolved[pointer], Digits::kForPeople);
      } else if (at.below_given || optional_part) {
        key.value = plain(line.otherwise);
        key.unit = "";
      }
      if (key.shown.empty()) key.shown = key.value;
      if (says_something(key.value)) keys.push_back(std::move(key));
    }
  }
  return keys;
}

std::string explanation_of_request(const std::string& name, const std::vector<UnderstoodKey>& keys) {
  std::string text = fmt::format("{}: nothing was planned; this is what is asked for\n", name);
  std::size_t widest = 0;
  for (const UnderstoodKey& key : keys) widest = std::max(widest, key.key.size());
  for (const UnderstoodKey& key : keys) {
    const bool weight = key.key.starts_with("objective.");
    if (weight && !key.given && key.value == "0") continue;
    const bool number = key.value.find_first_of("0123456789") < 3 && key.value[0] != '{';  // or a list of them
    const std::string unit = !number || key.unit.empty() || key.unit == "1" ? "" : " " + key.unit;
    const std::string note = key.note.empty() ? "" : ' ' + key.note + unit;
    text += fmt::format("  {:<8} {:<{}}  {}{}{}\n", key.given ? "given" : "default", key.key, widest, key.shown, unit,
                        note);
  }
  return text;
}

Json explanation_json(const std::string& name, const std::vector<UnderstoodKey>& keys) {
  Json list = Json::array();
  for (const UnderstoodKey& key : keys) {
    list.push_back(
        {{"key", key.key}, {"value", key.value}, {"unit", key.unit}, {"given", key.given}, {"meaning", key.meaning}});
    if (!key.note.empty()) list.back()["note"] = key.note;
  }
  return {{"version", FJR_VERSION}, {"request", name}, {"keys", std::move(list)}};
}

}  // namespace fjr
