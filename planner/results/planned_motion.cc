#include "planner/results/planned_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/request/request.h"
#include "planner/request/request_keys.h"
#include "planner/results/json_field.h"
#include "planner/results/plan_json.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

std::optional<Joints<double>> pair_or_null(const YamlNode& map, const char* key, const char* unit) {
  const auto found = map.find(key);
  return found && !found->is_null() ? std::optional(found->pair(unit)) : std::nullopt;
}

State<double> read_state(const YamlNode& state) {
  return {state.at("q").pair("rad"), state.at("dq").pair("rad/s"), state.at("theta").pair("rad"),
          state.at("dtheta").pair("rad/s")};
}

Goal read_goal(const YamlNode& node) {
  Goal goal;
  const std::vector<YamlNode> q = node.at("q").items();
  if (q.size() != kJoints) node.at("q").fail("must be a list of two angles or null");
  for (std::size_t j = 0; j < kJoints; ++j) {
    goal.free[j] = q[j].is_null();
    if (!goal.free[j]) goal.q[j] = q[j].number("rad");
  }
  goal.at_rest = node.at("at_rest").truth();
  const auto dq_free = node.find("dq_free");
  goal.dq_free = dq_free ? dq_free->truth() : !goal.at_rest;
  goal.dq = node.at("dq").pair("rad/s");
  goal.theta = pair_or_null(node, "theta", "rad");
  goal.dtheta = pair_or_null(node, "dtheta", "rad/s");
  return goal;
}

// tolerance: default [rad] for a plan.json of an earlier version, which does not contain it.
Via read_via(const YamlNode& node, double tolerance) {
  Via via;
  via.tolerance = tolerance;
  if (const YamlNode time = node.at("time"); !time.is_null()) via.time = time.number("s");
  via.q = node.at("q").pair("rad");
  via.dq = pair_or_null(node, "dq", "rad/s");
  if (const auto said = node.find("tolerance")) via.tolerance = said->number("rad");
  return via;
}

Limits read_limits(const YamlNode& given) {
  Limits limits = Limits::all(kNoLimit);
  for (const LimitName& name : kLimitNames) {
    const auto found = given.find(name.quantity->name);
    if (!found) continue;
    const bool of_joints = name.joint > 0;
    if (of_joints && (!found->is_list() || found->items().size() != kJoints)) found->fail("must be a list of two");
    const YamlNode value = of_joints ? found->items()[name.j()] : *found;
    if (!value.is_null()) name.in(limits) = value.number(name.quantity->unit);
  }
  return limits;
}

// Returns only the limits that are tighter than those of the robot that it was planned for; another robot need not keep
// the latter.
Limits tighter(Limits asked, const Limits& of_robot) {
  for (const LimitName& name : kLimitNames) {
    if (!(name.in(asked) < name.in(of_robot))) name.in(asked) = kNoLimit;
  }
  return asked;
}

void read_ends(const YamlNode& plan, PlannedMotion& planned) {
  const auto add_end = [&](const YamlNode& time) {
    const double end = time.number("s"), before = planned.ends.empty() ? 0 : planned.ends.back();
    if (!(end > before)) time.fail(fmt::format("{} s is not later than {} s, where the segment begins", end, before));
    planned.ends.push_back(end);
  };
  const YamlNode via_times = plan.at("via_times");
  for (const YamlNode& time : via_times.items()) add_end(time);
  add_end(plan.at("duration"));
  const auto ask = [&](std::size_t segments, const char* of_what) {
    if (segments == planned.ends.size()) return;
    via_times.fail(fmt::format("has {} times, but {} has {} segments", planned.ends.size() - 1, of_what, segments));
  };
  if (const std::optional<JointPath>& path = planned.task.path) ask(path->corners.size() - 1, "the path");
  if (!planned.via.empty()) ask(planned.via.size() + 1, "the way through the via points");
}

// Returns the values of a robot by their names, as far as they are there: spring.stiffness, ...
std::map<std::string, Joints<double>> values_of(const YamlNode& robot) {
  std::map<std::string, Joints<double>> values;
  Parameters known;
  visit_parameters(known, [&](const char* section, const char* name, const char* unit, const Joints<double>&) {
    const auto group = robot.find(section);
    const auto value = group ? group->find(name) : std::nullopt;
    if (value && !value->is_null()) values.emplace(fmt::format("{}.{}", section, name), value->pair(unit));
  });
  return values;
}

// Returns when the segments end that a request asks for. [s] planned: as plan.json says; end: of the trajectory.
std::vector<double> segment_ends(const Problem& request, const std::vector<double>& planned, double end) {
  if (request.via.size() + 1 == planned.size()) return planned;
  std::vector<double> ends;
  for (std::size_t i = 0; i < request.via.size(); ++i) {
    if (!request.via[i].time) {
      if (request.task.path) {
        throw InputError(request.name, "path", "needs the folder of its plan, which says when its corners are passed");
      }
      throw InputError(request.name, fmt::format("via[{}].time", i),
                       "is free, and no plan.json with as many via points says when this one is passed");
    }
    ends.push_back(std::min(*request.via[i].time, end));
  }
  ends.push_back(planned.empty() ? end : planned.back());
  return ends;
}

PlannedMotion read_motion(const YamlNode& plan) {
  const YamlNode request = plan.at("resolved_request");
  PlannedMotion planned{read_task(request.at("task")), {}};
  if (const auto limits = request.find("limits")) planned.limits = read_limits(*limits);
  if (const auto robot = plan.find("robot")) {
    planned.limits = tighter(planned.limits, read_limits(robot->at("limits")));
    if (const auto payload = robot->find("payload")) {
      planned.payload = read_payload(*payload);
    }
    planned.robot_values = values_of(*robot);
  }
  if (const auto proven = request.find("proven")) planned.proven = proven->truth();
  if (const auto robust = request.find("robust"); robust && !robust->is_null()) {
    const YamlNode confidence = robust->at("confidence");
    planned.robust = confidence.number("1");
    if (!(*planned.robust >= kLeastConfidence && *planned.robust <= kMostConfidence)) {
      confidence.fail(fmt::format("{} is outside [{}, {}]", *planned.robust, kLeastConfidence, kMostConfidence));
    }
  }
  if (const auto start = request.find("start")) planned.start = read_state(*start);
  if (const auto goal = request.find("goal")) planned.goals.push_back(read_goal(*goal));
  if (const auto others = request.find("other_goals")) {
    for (const YamlNode& goal : others->items()) planned.goals.push_back(read_goal(goal));
  }
  if (const auto duration = request.find("duration")) {
    planned.duration = {duration->at("min").number("s"), duration->at("max").number("s")};
  }
  if (const auto vias = request.find("via")) {
    const double tolerance = planned.task.path ? planned.task.path->tolerance : 0;
    for (const YamlNode& via : vias->items()) planned.via.push_back(read_via(via, tolerance));
  }
  if (const auto hash = plan.find("request_hash")) planned.request_hash = hash->text();
  if (const auto hash = plan.find("robot_hash")) planned.robot_hash = hash->text();
  if (const auto status = plan.find("status")) planned.status = status->text();
  if (const auto verdict = plan.find("verdict")) planned.verdict = verdict->text();
  read_ends(plan, planned);
  return planned;
}

}  // namespace

// Reads strictly only what describes the motion; other parts may be longer than any request.
PlannedMotion planned_motion_in(const Json& plan, const std::string& source) {
  Json relevant = Json::object();
  for (const char* key :
       {"status", "request_hash", "robot_hash", "resolved_request", "robot", "via_times", "duration"}) {
    if (plan.is_object() && plan.contains(key)) relevant[key] = plan[key];
  }
  const auto verdict = Json::json_pointer("/certificate/verdict");
  if (plan.is_object() && plan.contains(verdict)) relevant["verdict"] = plan[verdict];
  return read_motion(YamlNode::parse(json_text(relevant), source));
}

Task planned_task_in(const Json& plan, const std::string& source) {
  Json relevant;
  relevant["resolved_request"]["task"] = JsonField(plan, source).at("resolved_request").at("task").json();
  return read_task(YamlNode::parse(json_text(relevant), source).at("resolved_request").at("task"));
}

PlannedMotion requested_motion(const Problem& request, PlannedMotion of_plan, const Trajectory& trajectory) {
  PlannedMotion motion;
  motion.task = request.task;
  motion.ends = segment_ends(request, of_plan.ends, trajectory.end_time());
  motion.limits = tighter(request.limits, Limits::of(request.robot));
  motion.start = request.start;
  motion.goals = {request.goal};
  motion.goals.insert(motion.goals.end(), request.other_goals.begin(), request.other_goals.end());
  motion.duration = request.duration;
  motion.payload = request.robot.payload;
  motion.via = request.via;
  motion.proven = request.proven;
  motion.robust = request.robust;
  motion.robot_values = std::move(of_plan.robot_values);
  motion.verdict = std::move(of_plan.verdict);
  motion.request_hash = request.request_hash;
  motion.told_by = fmt::format("the request {}", request.name);
  motion.robot_hash = std::move(of_plan.robot_hash);
  motion.status = std::move(of_plan.status);
  return motion;
}

PlannedMotion planned_motion(const std::filesystem::path& folder) {
  return planned_motion_in(load_plan_json(folder), (folder / "plan.json").string());
}

}  // namespace fjr
