// The files of a planned request, the same whoever planned it.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// So that a trajectory file says by itself what it is for: request, robot, payload, tightened limits, as plan.json has
// them.
void describe(Trajectory& trajectory, const nlohmann::ordered_json& plan);

// What a plan came to. Without motion: no trajectory. Trajectories are described.
struct PlanFiles {
  const nlohmann::ordered_json& plan;
  const Trajectory* trajectory = nullptr;
  const Collocated* solution = nullptr;  // for warm starts
};

// Writes plan.json, and of a certified plan its trajectory and solution; of an uncertified one, where that is to be
// kept, likewise, under the trajectory's other name. folder: the stage of NewResults. Returns the names for people.
std::vector<std::string> write_plan_files(const PlanFiles& files, const std::filesystem::path& folder,
                                          bool keep_uncertified);

// report.html from the other files in the folder (plan_record.h); returns its path.
std::filesystem::path write_report(const std::filesystem::path& folder);

}  // namespace fjr
