// The contents of a plan's folder, from which reports are made.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

struct PlanRecord {
  std::string source;                    // path of plan.json, for messages
  nlohmann::ordered_json plan;           // plan.json
  Parameters robot;                      // the one it was planned for
  std::optional<Trajectory> trajectory;  // empty if no trajectory was kept
};

// Returns the record for a plan.json and its trajectory. The robot is read from plan.json and checked against
// robot_hash. Throws InputError as read_plan() does.
PlanRecord record_of(nlohmann::ordered_json plan, std::string source, std::optional<Trajectory> trajectory);

// Reads plan.json and trajectory.csv, or trajectory.uncertified.csv for an uncertified plan. Throws InputError if the
// folder or files do not exist, are damaged or do not belong together, or if the request was refused, so that nothing
// was planned.
PlanRecord read_plan(const std::filesystem::path& folder);

}  // namespace fjr
