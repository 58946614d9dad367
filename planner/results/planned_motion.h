// The requested motion as described in plan.json, or as a request asks for it.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

struct PlannedMotion {
  Task task;
  std::vector<double> ends;                              // [s] of the motion's segments
  Limits limits = Limits::all(kNoLimit);                 // only those that are tighter than those of its robot
  std::optional<State<double>> start{};                  // empty if not given
  std::vector<Goal> goals{};                             // alternatives; empty if not given
  Duration duration{0, kNoLimit};                        // [s]
  std::optional<Payload> payload{};                      // none: not said
  std::map<std::string, Joints<double>> robot_values{};  // spring.stiffness, ...: of the robot, as far as it is said
  bool proven = false;                                   // asked for
  std::optional<double> robust{};                        // fraction of the arms asked for
  std::vector<Via> via{};
  std::string request_hash{}, robot_hash{}, status{};  // empty: not said
  std::string verdict{};                               // of its certificate: "certified", "failed"; empty: not said
  std::string told_by = "plan.json";                   // who says so, for messages
};

// Reads plan.json in the folder of a plan. Throws InputError if it does not exist or describes no motion, or if its
// via_times do not fit the segments of the motion.
PlannedMotion planned_motion(const std::filesystem::path& folder);
// Returns the motion in a plan.json that was read already. source: its name in messages.
PlannedMotion planned_motion_in(const nlohmann::ordered_json& plan, const std::string& source);
// Returns only its task. Nothing else of the plan needs to be readable.
Task planned_task_in(const nlohmann::ordered_json& plan, const std::string& source);

// Returns what a request asks of a trajectory. of_plan: the motion of the plan.json beside it, or an empty one: the
// times of via points that the request leaves free, status and robot_hash are taken from there. Throws InputError if
// such a time is not there.
PlannedMotion requested_motion(const Problem& request, PlannedMotion of_plan, const Trajectory& trajectory);

}  // namespace fjr
