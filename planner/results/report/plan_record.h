// A plan as it lies in its folder: everything a report is made of.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

struct PlanRecord {
  std::string source;                    // of the plan, for messages: the path of plan.json
  nlohmann::ordered_json plan;           // plan.json
  Parameters robot;                      // the one it was planned for
  std::optional<Trajectory> trajectory;  // none: nothing came of it that was to be kept
};

// From what a plan.json says and the trajectory that goes with it. The robot is the one in plan.json, held against its
// robot_hash. InputError as below.
PlanRecord record_of(nlohmann::ordered_json plan, std::string source, std::optional<Trajectory> trajectory);

// Reads plan.json, and trajectory.csv beside it, or trajectory.uncertified.csv of a plan that is uncertified.
// InputError: no such folder or files, or they are damaged, or do not belong together, or the request was refused, so
// that nothing was planned.
PlanRecord read_plan(const std::filesystem::path& folder);

}  // namespace fjr
