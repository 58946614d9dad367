#include "planner/batch/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string_view>
#include <utility>

#include "common/input_error.h"
#include "common/rounded.h"
#include "common/strict_yaml.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestName = 200;  // file systems allow 255, and extensions are appended
constexpr std::size_t kLongestIndex = 4;   // [digits]
constexpr int kDigits = 12;

struct Value {
  Json json;
  std::string name;  // its part of the request's name
};

struct Axis {
  YamlNode node;
  std::string path;           // "goal.q[0]"
  Json::json_pointer target;  // "/goal/q/0"
  std::vector<Value> values;
};

// ---- requests as JSON, which is YAML too ----

// Whole numbers without a point: a seed has to be one.
Json number_json(double number) {
  constexpr double kExact = 1LL << 53;
  const bool whole = number == std::trunc(number) && std::abs(number) < kExact;
  return whole ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

Json scalar_json(const YamlNode& node) {
  if (!node.is_number()) return node.text();
  const std::string& text = node.text();
  std::uint64_t whole = 0;  // a seed may have more digits than a double
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error == std::errc() && end == text.data() + text.size()) return whole;
  return number_json(node.number("1"));
}

Json to_json(const YamlNode& node) {
  if (node.is_null()) return nullptr;
  if (node.is_scalar()) return scalar_json(node);
  if (node.is_list()) {
    Json list = Json::array();
    for (const YamlNode& item : node.items()) list.push_back(to_json(item));
    return list;
  }
  Json map = Json::object();
  for (const std::string& key : node.keys()) map[key] = to_json(node.at(key));
  return map;
}

// One line for every key of the request.
std::string to_yaml(const Json& request) {
  const auto text = [](const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); };
  std::string yaml;
  for (const auto& [key, value] : request.items()) yaml += fmt::format("{}: {}\n", text(key), text(value));
  return yaml;
}

// Makes the path of the robot absolute, because requests are written to another folder than the file that names it.
void make_robot_absolute(Json& request, const fs::path& folder) {
  const auto robot = request.find("robot");
  if (robot == request.end() || !robot->is_string()) return;
  *robot = fs::absolute(folder / robot->get<std::string>()).lexically_normal().string();
}

Json standing_alone_json(const YamlNode& request, const fs::path& folder) {
  Json json = to_json(request);
  make_robot_absolute(json, folder);
  return json;
}

fs::path folder_of(const YamlNode& root) { return fs::path(root.source()).parent_path(); }

Json read_template(const YamlNode& root) {
  if (!root.find("request")) {
    throw InputError(root.source(), "request",
                     "missing: a grid has a request, or the name of a request's file, of which the axes change values");
  }
  const YamlNode given = root.at("request");
  const YamlNode request = given.is_scalar() ? YamlNode::load(folder_of(root) / given.text()) : given;
  if (!request.is_map()) request.fail("must be a request, or the name of a request's file");
  if (is_grid(request)) request.fail("is a grid; a request is needed here");
  return standing_alone_json(request, folder_of(request));
}

// ---- paths ----

struct Step {
  std::string word;
  bool index;  // [word], else .word
};

// "goal.q[0]" as goal, q, 0.
std::vector<Step> steps_of(const YamlNode& axis, std::string_view path) {
  std::vector<Step> steps;
  const auto require = [&](bool valid) {
    if (!valid) axis.fail("is not the path of a value, such as goal.q[0]");
  };
  while (!path.empty()) {
    const bool index = path.front() == '[';
    require(index ? !steps.empty() : steps.empty() || path.front() == '.');
    if (index || !steps.empty()) path.remove_prefix(1);
    const std::size_t length = std::min(path.find_first_of(index ? "]" : ".["), path.size());
    require(length > 0);
    require(!index || (length < path.size() && length <= kLongestIndex));
    steps.push_back({std::string(path.substr(0, length)), index});
    path.remove_prefix(length + (index ? 1 : 0));
  }
  require(!steps.empty());
  return steps;
}

// Returns the place in the request that a path leads to. Only the last key may be new, so that a mistyped path is
// noticed.
Json::json_pointer target_of(const YamlNode& axis, std::string_view path, const Json& request) {
  const std::vector<Step> steps = steps_of(axis, path);
  Json::json_pointer target;
  const Json* place = &request;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& [word, index] = steps[i];
    const std::string so_far = target.empty() ? "the request" : "the request's " + target.to_string().substr(1);
    if (!(index ? place->is_array() : place->is_object())) {
      axis.fail(fmt::format("{} is no {}", so_far, index ? "list" : "map"));
    }
    target.push_back(word);
    if (request.contains(target)) {
      place = &request.at(target);
    } else if (index || i + 1 < steps.size()) {
      axis.fail(fmt::format("{} has no {}", so_far, shown(word)));
    }
  }
  return target;
}

void check_overlap(const std::vector<Axis>& axes) {
  for (const Axis& outer : axes) {
    for (const Axis& inner : axes) {
      const bool within = inner.path.size() > outer.path.size() && inner.path.starts_with(outer.path) &&
                          (inner.path[outer.path.size()] == '.' || inner.path[outer.path.size()] == '[');
      if (within) inner.node.fail(fmt::format("lies within the axis {}", outer.path));
    }
  }
}

// ---- values ----

// Replaces characters that not every file system accepts in a file name by '-'.
std::string for_file_name(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) {
        const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return !plain && std::string_view("._+-").find(c) == std::string_view::npos;
      },
      '-');
  return text;
}

// Lists and maps have no short name: they are counted, from 1.
Value listed_value(const YamlNode& item, const Axis& axis, std::size_t index) {
  Json json = to_json(item);
  if (axis.path == "robot" && json.is_string()) {
    return {json, for_file_name(fs::path(json.get<std::string>()).stem().string())};
  }
  if (json.is_string()) return {json, for_file_name(json.get<std::string>())};
  if (json.is_number()) return {json, json.is_number_float() ? fmt::format("{}", json.get<double>()) : json.dump()};
  return {json, fmt::format("{}{}", for_file_name(axis.target.back()), index + 1)};
}

std::vector<Value> read_range(const YamlNode& node) {
  node.allow_keys({"from", "to", "count"});
  const double from = node.at("from").number("1"), to = node.at("to").number("1");
  std::vector<Value> values;
  for (const double number : equidistant(from, to, node.at("count").whole_number(1, kMaxGridPoints))) {
    values.push_back({number_json(number), fmt::format("{}", number)});
  }
  return values;
}

std::vector<Value> read_values(const Axis& axis) {
  if (axis.node.is_map()) return read_range(axis.node);
  if (!axis.node.is_list()) axis.node.fail("must be a list of values or {from: ..., to: ..., count: ...}");
  const std::vector<YamlNode> items = axis.node.items();
  std::vector<Value> values;
  for (std::size_t i = 0; i < items.size(); ++i) values.push_back(listed_value(items[i], axis, i));
  if (values.empty()) axis.node.fail("has no values");
  return values;
}

void refuse_equal_names(const Axis& axis) {
  std::set<std::string> names;
  for (const Value& value : axis.values) {
    if (!names.insert(value.name).second) {
      axis.node.fail(fmt::format("two values would be called '{}' in the requests' names", value.name));
    }
  }
}

Axis read_axis(const YamlNode& axes, const std::string& path, const Json& request) {
  Axis axis{axes.at(path), path, Json::json_pointer(), {}};
  axis.target = target_of(axis.node, path, request);
  axis.values = read_values(axis);
  refuse_equal_names(axis);
  return axis;
}

std::vector<Axis> read_axes(const YamlNode& root, const Json& request) {
  if (!root.find("axes")) {
    throw InputError(root.source(), "axes",
                     "missing: a grid names what changes from request to request, such as goal.q[0]: [0.8, 1, 1.2]; "
                     "a single request stands in a file by itself, without `request:`");
  }
  const YamlNode node = root.at("axes");
  std::vector<Axis> axes;
  std::size_t points = 1;
  if (!node.is_map() || node.keys().empty()) node.fail("must be a map from paths, such as goal.q[0], to their values");
  for (const std::string& path : node.keys()) {
    axes.push_back(read_axis(node, path, request));
    points *= axes.back().values.size();
    if (points > kMaxGridPoints) node.fail(fmt::format("more than the {} requests allowed", kMaxGridPoints));
  }
  check_overlap(axes);
  return axes;
}

// ---- points ----

GridPoint point(const YamlNode& root, Json request, const std::vector<Axis>& axes, std::size_t index) {
  GridPoint point{"", Json::object(), ""};
  std::string name;
  for (auto axis = axes.rbegin(); axis != axes.rend(); ++axis) {
    const Value& value = axis->values[index % axis->values.size()];
    index /= axis->values.size();
    request[axis->target] = value.json;
    name = "_" + value.name + name;
  }
  for (const Axis& axis : axes) point.axes[axis.path] = request[axis.target];
  point.name = fs::path(root.source()).stem().string() + name;
  if (point.name.size() > kLongestName) {
    root.at("axes").fail(fmt::format("the name {} has more than {} characters", shown(point.name), kLongestName));
  }
  make_robot_absolute(request, folder_of(root));
  point.yaml = fmt::format("# A point of {}\n{}", shown(root.source()), to_yaml(request));
  return point;
}

}  // namespace

bool is_grid(const YamlNode& root) { return root.is_map() && (root.find("axes") || root.find("request")); }

std::vector<double> equidistant(double from, double to, std::size_t count) {
  if (count == 1) return {from};
  std::vector<double> values;
  const double steps = static_cast<double>(count - 1), smallest = 1e-12 * std::max(std::abs(from), std::abs(to));
  for (std::size_t i = 0; i < count; ++i) {
    const double done = static_cast<double>(i) / steps;
    const double value = from * (1 - done) + to * done;
    const double rounded = rounded_to(value, kDigits);
    values.push_back(std::abs(value) <= smallest ? 0 : rounded);
  }
  values.front() = from;
  values.back() = to;
  return values;
}

std::string standing_alone(const YamlNode& request, const fs::path& folder) {
  return to_yaml(standing_alone_json(request, folder));
}

std::vector<GridPoint> expand_grid(const YamlNode& root) {
  root.allow_keys({"request", "axes"});
  const Json request = read_template(root);
  const std::vector<Axis> axes = read_axes(root, request);
  std::size_t count = 1;
  for (const Axis& axis : axes) count *= axis.values.size();
  std::vector<GridPoint> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) points.push_back(point(root, request, axes, i));
  return points;
}

}  // namespace fjr
