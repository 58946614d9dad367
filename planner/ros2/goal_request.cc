#include "planner/ros2/goal_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace fjr {
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& why) {
  throw GoalRefused(ResultCode::kInvalidGoal, field + ": " + why);
}

std::array<std::size_t, kJoints> places(const FollowGoal& goal, const JointNames& names) {
  const auto& given = goal.joint_names.values;
  std::array<std::size_t, kJoints> place{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto found = std::find(given.begin(), given.end(), names[j]);
    if (found == given.end() || goal.joint_names.size != kJoints) {
      throw GoalRefused(
          ResultCode::kInvalidJoints,
          fmt::format("trajectory.joint_names: {} names, {}; they are to be exactly {} and {}, in any order",
                      goal.joint_names.size, given, names[0], names[1]));
    }
    place[j] = static_cast<std::size_t>(found - given.begin());
  }
  return place;
}

void refuse_what_fjr_has_not(const FollowGoal& goal) {
  if (goal.stamped) {
    refuse("trajectory.header.stamp", "is not 0; a motion starts once it is planned, and at no other time");
  }
  if (goal.multi_dof_trajectory) refuse("multi_dof_trajectory", "is not empty; the arm's joints are single");
  if (goal.component_path_tolerance) refuse("component_path_tolerance", "is not empty; the arm's joints are single");
  if (goal.component_goal_tolerance) refuse("component_goal_tolerance", "is not empty; the arm's joints are single");
}

// ---- points ----

class PointReader {
 public:
  PointReader(std::size_t index, const FollowPoint& point, const std::array<std::size_t, kJoints>& place)
      : name_(fmt::format("trajectory.points[{}]", index)), point_(point), place_(place) {
    if (point.effort.size > 0) refuse(name_ + ".effort", "is not empty; torques are the planner's");
  }

  Joints<double> positions() const { return pair(point_.positions, "positions"); }

  std::optional<Joints<double>> velocities() const {
    if (point_.velocities.size == 0) return std::nullopt;
    return pair(point_.velocities, "velocities");
  }

  void refuse_accelerations() const {
    if (point_.accelerations.size > 0)
      refuse(name_ + ".accelerations", "is not empty; between the ends they are the planner's");
  }

  void refuse_unless_at_rest() const {
    refuse_unless_zero(point_.velocities, "velocities");
    refuse_unless_zero(point_.accelerations, "accelerations");
  }

  double time() const { return point_.time_from_start; }

  void check_time_after(double before) const {
    if (time() > before) return;
    refuse(name_ + ".time_from_start", fmt::format("{} s is not after the {} s of the point before", time(), before));
  }

  void check_no_time() const {
    if (time() == 0) return;
    refuse(name_ + ".time_from_start",
           fmt::format("{} s; where the last one is 0, for as fast as can be, all are", time()));
  }

  void check_is_duration() const {
    if (time() >= 0) return;  // NaN is none
    refuse(name_ + ".time_from_start", "is negative, or has a second or more of nanoseconds");
  }

 private:
  void check_size(const CutList<double>& list, const char* what) const {
    if (list.size == kJoints) return;
    refuse(fmt::format("{}.{}", name_, what), fmt::format("{} values, there are {} joints", list.size, kJoints));
  }

  Joints<double> pair(const CutList<double>& list, const char* what) const {
    check_size(list, what);
    Joints<double> values{};
    for (std::size_t j = 0; j < kJoints; ++j) {
      values[j] = list.values[place_[j]];
      if (!std::isfinite(values[j])) {
        refuse(fmt::format("{}.{}[{}]", name_, what, place_[j]), fmt::format("{} is no finite number", values[j]));
      }
    }
    return values;
  }

  void refuse_unless_zero(const CutList<double>& list, const char* what) const {
    if (list.size == 0) return;
    const Joints<double> values = pair(list, what);
    if (values == Joints<double>{}) return;
    refuse(fmt::format("{}.{}", name_, what), "is not 0; a motion begins and ends at rest");
  }

  std::string name_;
  const FollowPoint& point_;
  const std::array<std::size_t, kJoints>& place_;
};

std::string text_of_pair(const Joints<double>& pair) { return fmt::format("[{}, {}]", pair[0], pair[1]); }

std::string via_text(const PointReader& point, bool timed, bool leave_accelerations) {
  if (!leave_accelerations) point.refuse_accelerations();
  std::string text = "q: " + text_of_pair(point.positions());
  if (const auto dq = point.velocities()) text += ", dq: " + text_of_pair(*dq);
  if (timed) text += fmt::format(", time: {}", point.time());
  return "{" + text + "}";
}

void check_times(const std::vector<PointReader>& points) {
  for (const PointReader& point : points) point.check_is_duration();
  const bool timed = points.back().time() > 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!timed) points[i].check_no_time();
    if (timed && i > 0) points[i].check_time_after(points[i - 1].time());
  }
}

// A first point at time 0 of a timed trajectory says where the arm rests, which the executor compares.
void read_points(const FollowGoal& goal, bool leave_accelerations, GoalRequest& request) {
  const std::size_t count = goal.points.size;
  if (count == 0) refuse("trajectory.points", "is empty; a goal is needed");
  const bool timed = goal.points.values.back().time_from_start > 0;
  const bool from_start = timed && count > 1 && goal.points.values.front().time_from_start == 0;
  const std::size_t first = from_start ? 1 : 0;
  if (count - 1 - first > kMostIntermediatePoints) {
    refuse(
        "trajectory.points",
        fmt::format("{} points between start and goal, above the {} allowed; they are passed exactly by a motion that "
                    "fjr plans itself: send the few that matter, or only the goal",
                    count - 1 - first, kMostIntermediatePoints));
  }
  std::vector<PointReader> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(i, goal.points.values[i], request.place);
  check_times(points);
  if (from_start) {
    points.front().refuse_unless_at_rest();
    request.document = fmt::format("start: {{q: {}}}\n", text_of_pair(points.front().positions()));
  }
  points.back().refuse_unless_at_rest();
  request.document += fmt::format("goal: {{q: {}}}\n", text_of_pair(points.back().positions()));
  if (timed) request.document += fmt::format("duration: {}\n", points.back().time());
  if (first + 1 < count) request.document += "via:\n";
  for (std::size_t i = first; i + 1 < count; ++i) {
    request.document += fmt::format("  - {}\n", via_text(points[i], timed, leave_accelerations));
  }
}

// ---- tolerances ----

void check_unused(const std::string& field, double value, const char* what) {
  if (value == 0) return;
  refuse(field, fmt::format("{} is not 0; {} are not watched against tolerances of a goal", value, what));
}

Joints<double> read_tolerance(const std::string& field, const CutList<FollowTolerance>& list, const JointNames& names) {
  Joints<double> allowed{};
  std::set<std::string> seen;
  if (list.size > kJoints) refuse(field, fmt::format("{} entries, there are {} joints", list.size, kJoints));
  for (std::size_t i = 0; i < list.size; ++i) {
    const FollowTolerance& one = list.values[i];
    const std::string entry = fmt::format("{}[{}]", field, i);
    const auto found = std::find(names.begin(), names.end(), one.joint);
    if (found == names.end())
      refuse(entry + ".name", fmt::format("'{}' is neither {} nor {}", one.joint, names[0], names[1]));
    if (!seen.insert(one.joint).second) refuse(entry + ".name", fmt::format("'{}' comes twice", one.joint));
    if (!(one.position >= 0)) {
      refuse(entry + ".position", fmt::format("{}; the executor's own tolerance cannot be taken away", one.position));
    }
    check_unused(entry + ".velocity", one.velocity, "velocities");
    check_unused(entry + ".acceleration", one.acceleration, "accelerations");
    allowed[static_cast<std::size_t>(found - names.begin())] = one.position;
  }
  return allowed;
}

void read_tolerances(const FollowGoal& goal, const JointNames& names, GoalRequest& request) {
  request.path_tolerance = read_tolerance("path_tolerance", goal.path_tolerance, names);
  request.goal_tolerance = read_tolerance("goal_tolerance", goal.goal_tolerance, names);
  if (!(goal.goal_time_tolerance >= 0)) {
    refuse("goal_time_tolerance", "is negative, or has a second or more of nanoseconds");
  }
  request.on_time = goal.goal_time_tolerance > 0;
  if (request.on_time && !(request.goal_tolerance[0] > 0 && request.goal_tolerance[1] > 0)) {
    refuse("goal_time_tolerance", "needs a goal_tolerance of both joints; without one the executor's own time holds");
  }
}

std::optional<FollowResult> beyond(const GoalRequest& request, ResultCode code, const Joints<double>& error,
                                   const Joints<double>& allowed, std::string_view what) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (allowed[j] == 0 || std::abs(error[j]) <= allowed[j]) continue;
    return FollowResult{code, fmt::format("{}: {:.3g} rad {}, more than the goal's tolerance of {:g}",
                                          request.joint_names[request.place[j]], std::abs(error[j]), what, allowed[j])};
  }
  return std::nullopt;
}

}  // namespace

GoalRequest request_of(const FollowGoal& goal, const GoalReading& reading) {
  GoalRequest request;
  request.place = places(goal, reading.names);
  request.joint_names = goal.joint_names.values;
  refuse_what_fjr_has_not(goal);
  read_tolerances(goal, reading.names, request);
  read_points(goal, reading.leave_accelerations, request);
  return request;
}

FollowResult judged(const GoalRequest& request, const ExecutionResult& executed) {
  if (executed.code != ResultCode::kSuccessful) return {executed.code, executed.sentence};
  const auto check = [&](ResultCode code, const Joints<double>& error, const Joints<double>& allowed,
                         const char* what) { return beyond(request, code, error, allowed, what); };
  if (auto fault =
          check(ResultCode::kPathToleranceViolated, executed.link_error, request.path_tolerance, "off the path")) {
    return *fault;
  }
  if (auto fault = check(ResultCode::kGoalToleranceViolated, executed.final_link_error, request.goal_tolerance,
                         "off the goal at the end")) {
    return *fault;
  }
  if (!request.on_time) return {};
  return check(ResultCode::kGoalToleranceViolated, executed.residual_vibration, request.goal_tolerance,
               "off the goal after the end of the motion, so that when it came is not known")
      .value_or(FollowResult{});
}

std::optional<FollowResult> strayed(const GoalRequest& request, const ExecutorState& state) {
  const Joints<double> error{state.q[0] - state.planned_q[0], state.q[1] - state.planned_q[1]};
  return beyond(request, ResultCode::kPathToleranceViolated, error, request.path_tolerance, "off the path");
}

FollowFeedback feedback_of(const GoalRequest& request, double time, const ExecutorState& state) {
  FollowFeedback feedback;
  feedback.joint_names = request.joint_names;
  feedback.time = time;
  for (std::size_t j = 0; j < kJoints; ++j) {
    feedback.desired[request.place[j]] = state.planned_q[j];
    feedback.actual[request.place[j]] = state.q[j];
    feedback.speed[request.place[j]] = state.dq[j];
  }
  return feedback;
}

}  // namespace fjr
