#include "common/mcap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "model/kinematics.h"
#include "planner/problem/quantities.h"
#include "planner/problem/task/task.h"
#include "planner/results/export/formats.h"
#include "planner/results/json_field.h"
#include "planner/results/planned_motion.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFrame = 0.02;  // [s] between pictures of the arm
constexpr double kFlat = 0.02;   // [m] of an obstacle's drawing: the arm moves in a plane
constexpr double kLongWall = 5;  // [m]
const char* const kFrameId = "base";

std::uint64_t nanoseconds(double time) { return static_cast<std::uint64_t>(std::llround(time * 1e9)); }

// A schema of numbers by their names.
std::string schema_of(const std::string& title, const std::vector<std::string>& names) {
  Json properties = Json::object();
  for (const std::string& name : names) properties[name] = {{"type", "number"}};
  return Json{{"title", title}, {"type", "object"}, {"properties", std::move(properties)}, {"required", names}}.dump();
}

// Those columns of a table on a topic of their own.
void add_table(McapWriter& file, const std::string& topic, const std::string& title, const ExportTable& table,
               const std::vector<std::string>& names) {
  const std::uint16_t id = file.add_topic(topic, "json", title, "jsonschema", schema_of(title, names));
  const std::vector<double>& time = table.column("time_s");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    Json message = Json::object();
    for (const std::string& name : names) message[name] = table.column(name)[row];
    file.add(id, nanoseconds(time[row]), message.dump());
  }
}

// "torque" of joint 1 -> "torque_1"; with the unit as columns have it. end: "_lowest", of a range that is not to either
// side of zero.
std::string limit_name(const LimitName& limit, const char* end = "") {
  std::string unit = limit.quantity->unit;
  for (std::size_t slash = unit.find('/'); slash != std::string::npos; slash = unit.find('/')) {
    unit.replace(slash, 1, "_per_");
  }
  for (char& c : unit) c = c == ' ' ? '_' : c;
  const std::string joint = limit.joint == 0 ? "" : fmt::format("_{}", limit.joint);
  return fmt::format("{}{}{}_{}", limit.quantity->name, joint, end, unit);
}

// The limits of the plan at both ends, so that they are drawn as lines.
void add_limits(McapWriter& file, const PlanRecord& plan, double end) {
  std::vector<std::string> names;
  Json message = Json::object();
  const auto add = [&](std::string name, Json value) {
    message[name] = std::move(value);
    names.push_back(std::move(name));
  };
  const Limits of_robot = Limits::of(plan.robot);
  const JsonField limits = JsonField(plan.plan, plan.source).at("resolved_request").at("limits");
  for (const LimitName& limit : kLimitNames) {
    const auto found = limits.find(limit.quantity->name);
    if (!found) continue;
    const double value = limit.joint == 0 ? found->number() : found->pair()[limit.j()];
    if (std::isnan(value)) continue;  // of the other joint alone
    const double middle = limit.joint == 0 ? 0 : limit.quantity->counted_from(of_robot, limit.j());
    if (middle == 0) {
      add(limit_name(limit), value);
    } else {
      add(limit_name(limit, "_lowest"), middle - value);
      add(limit_name(limit, "_highest"), middle + value);
    }
  }
  const std::uint16_t id =
      file.add_topic("/fjr/limits", "json", "fjr.Limits", "jsonschema", schema_of("fjr.Limits", names));
  for (const double time : {0.0, end}) file.add(id, nanoseconds(time), message.dump());
}

// ---- the scene, as Foxglove's schema SceneUpdate has it ----

Json time_json(double time) {
  const std::uint64_t ns = nanoseconds(time);
  return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}};
}
Json point(double x, double y) { return {{"x", x}, {"y", y}, {"z", 0.0}}; }
Json pose(double x, double y) {
  return {{"position", point(x, y)}, {"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}}}};
}
Json color(double r, double g, double b, double a) { return {{"r", r}, {"g", g}, {"b", b}, {"a", a}}; }

Json entity(double time, const std::string& id) {
  Json json{{"timestamp", time_json(time)},
            {"frame_id", kFrameId},
            {"id", id},
            {"lifetime", {{"sec", 0}, {"nsec", 0}}},
            {"frame_locked", false}};
  for (const char* shape :
       {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    json[shape] = Json::array();
  }
  return json;
}

Json line_strip(std::vector<Json> points, double thickness, Json with) {
  return {{"type", 0},
          {"pose", pose(0, 0)},
          {"thickness", thickness},
          {"scale_invariant", false},
          {"points", std::move(points)},
          {"color", std::move(with)},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

Json arm_at(const Parameters& robot, const Sample& row) {
  const Point<double> elbow = elbow_position(robot, row.state.q), tip = tip_position(robot, row.state.q);
  Json arm = entity(row.time, "arm");
  arm["lines"].push_back(
      line_strip({point(0, 0), point(elbow.x, elbow.y)}, 2 * robot.link.radius[0], color(0.2, 0.4, 0.8, 1)));
  arm["lines"].push_back(
      line_strip({point(elbow.x, elbow.y), point(tip.x, tip.y)}, 2 * robot.link.radius[1], color(0.9, 0.5, 0.1, 1)));
  return arm;
}

// What task constraints draw themselves with, flat in the arm's plane; planner/problem/task has a draw() of each.
class TaskDrawing {
 public:
  TaskDrawing(const Parameters& of_robot, std::string id) : robot(of_robot), entity_(entity(0, id)) {}

  void disc(const Coordinates& center, double radius, double) {
    entity_["cylinders"].push_back({{"pose", pose(center[0], center[1])},
                                    {"size", {{"x", 2 * radius}, {"y", 2 * radius}, {"z", kFlat}}},
                                    {"bottom_scale", 1.0},
                                    {"top_scale", 1.0},
                                    {"color", color(0.8, 0.2, 0.2, 0.8)}});
  }
  void half_plane(const Coordinates& through, const Coordinates& normal) {
    const auto [x, y] = through;
    const double s = kLongWall / std::hypot(normal[0], normal[1]);
    const double along_x = -s * normal[1], along_y = s * normal[0];
    add_strip({{x + along_x, y + along_y}, {x - along_x, y - along_y}}, kFlat / 2, color(0.4, 0.4, 0.4, 1));
  }
  void box(const Coordinates& lower, const Coordinates& upper) {
    add_strip({lower, {upper[0], lower[1]}, upper, {lower[0], upper[1]}, lower}, kThin, kOfTip);
  }
  void line(const Coordinates& from, const Coordinates& to, double tolerance) {
    add_strip({from, to}, 2 * tolerance, kOfTip);
  }
  // from, to: angles [rad].
  void arc(const Coordinates& center, double radius, double from, double to, double tolerance) {
    constexpr int kPieces = 60;
    std::vector<Coordinates> points;
    for (int i = 0; i <= kPieces; ++i) {
      const double angle = std::lerp(from, to, i / double{kPieces});
      points.push_back({center[0] + radius * std::cos(angle), center[1] + radius * std::sin(angle)});
    }
    add_strip(points, 2 * tolerance, kOfTip);
  }
  void curve(const std::vector<Coordinates>& points) { add_strip(points, kThin, kOfTip); }

  Json done() { return std::move(entity_); }

  const Parameters& robot;

 private:
  static constexpr double kThin = 0.002;  // [m] of lines without a width of their own
  const Json kOfTip = color(0.2, 0.6, 0.3, 0.5);

  void add_strip(const std::vector<Coordinates>& through, double thickness, const Json& with) {
    std::vector<Json> points;
    for (const Coordinates& p : through) points.push_back(point(p[0], p[1]));
    entity_["lines"].push_back(line_strip(std::move(points), thickness, with));
  }

  Json entity_;
};

// "obstacles[0]" is entity "obstacle 1", and "tip_box" is "tip box".
std::string entity_of(std::string constraint) {
  std::replace(constraint.begin(), constraint.end(), '_', ' ');
  const std::size_t bracket = constraint.find("s[");
  if (bracket == std::string::npos) return constraint;
  return fmt::format("{} {}", constraint.substr(0, bracket), std::stoul(constraint.substr(bracket + 2)) + 1);
}

std::string scene(std::vector<Json> entities) {
  return Json{{"deletions", Json::array()}, {"entities", std::move(entities)}}.dump();
}

std::string scene_schema() {
  const Json any = {{"type", "array"}, {"items", {{"type", "object"}}}};
  return Json{{"title", "foxglove.SceneUpdate"},
              {"description", "An update to the entities displayed in a 3D scene"},
              {"type", "object"},
              {"properties", {{"deletions", any}, {"entities", any}}}}
      .dump();
}

void add_scene(McapWriter& file, const PlanRecord& plan, const std::vector<Sample>& rows) {
  const std::uint16_t id = file.add_topic("/fjr/scene", "json", "foxglove.SceneUpdate", "jsonschema", scene_schema());
  std::vector<Json> still;
  const Task task = planned_task_in(plan.plan, plan.source);
  each_constraint(task, [&](const std::string& name, const auto& constraint) {
    TaskDrawing drawing(plan.robot, entity_of(name));
    draw(constraint, drawing);
    still.push_back(drawing.done());
  });
  if (!still.empty()) file.add(id, 0, scene(std::move(still)));
  double next = 0;
  for (const Sample& row : rows) {
    if (row.time < next && &row != &rows.back()) continue;
    next = row.time + kFrame;
    file.add(id, nanoseconds(row.time), scene({arm_at(plan.robot, row)}));
  }
}

}  // namespace

std::string as_mcap(const Exported& exported) {
  McapWriter file("", "fjr " FJR_VERSION);
  if (exported.plan != nullptr) {
    const ExportTable table = table_of(exported.plan->robot, *exported.ticked);
    std::vector<std::string> tip, others;
    for (const std::string& name : table.names) (name.starts_with("tip_") ? tip : others).push_back(name);
    add_table(file, "/fjr/trajectory", "fjr.Trajectory", table, others);
    add_table(file, "/fjr/tip", "fjr.Tip", table, tip);
    add_limits(file, *exported.plan, exported.ticked->rows.back().time);
    add_scene(file, *exported.plan, exported.ticked->rows);
  }
  if (exported.log) {
    if (const double first = exported.log->column("time").front(); first < 0) {
      throw InputError(exported.log->source, "time",
                       fmt::format("{} s is before 0, and MCAP has no such times", first));
    }
    const ExportTable table = table_of(*exported.log);
    add_table(file, "/fjr/executed", "fjr.Executed", table, table.names);
  }
  return file.finish();
}

}  // namespace fjr
