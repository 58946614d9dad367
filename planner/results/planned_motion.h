// What plan.json says of the motion that was asked for.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct PlannedMotion {
  Task task;
  std::vector<double> ends;               // [s] of the motion's segments
  Limits limits = Limits::all(kNoLimit);  // those that are tighter than the robot's that it was planned for
  std::optional<State<double>> start{};   // none: not said
  std::vector<Goal> goals{};              // any of them will do; empty: not said
  Duration duration{0, kNoLimit};         // [s]
  std::optional<Payload> payload{};       // none: not said
  std::vector<Via> via{};
  std::string request_hash{}, status{};  // empty: not said
};

// From the plan.json in the folder of a plan. Throws InputError where there is none, or none of a motion, or where its
// via_times are no times between the motion's segments.
PlannedMotion planned_motion(const std::filesystem::path& folder);
// The same of a plan.json that was read already. source: what it is called in messages.
PlannedMotion planned_motion_in(const nlohmann::ordered_json& plan, const std::string& source);

}  // namespace fjr
