// Writes the files of a planned request, for the command line, batches and the service alike.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Adds request, robot, payload and tightened limits from plan.json to the metadata of a trajectory, so that its file is
// self-describing.
void describe(Trajectory& trajectory, const nlohmann::ordered_json& plan);

// The results of a plan. Without a motion there is no trajectory. describe() must have been applied to trajectories.
struct PlanFiles {
  const nlohmann::ordered_json& plan;
  const Trajectory* trajectory = nullptr;
  const Collocated* solution = nullptr;  // stored for warm starts
};

// Writes plan.json and, for a certified plan, its trajectory and solution. If an uncertified plan is to be kept, they
// are written as well, with the trajectory under its other name. folder: the stage of NewResults. Returns the names of
// the files for display.
std::vector<std::string> write_plan_files(const PlanFiles& files, const std::filesystem::path& folder,
                                          bool keep_uncertified);

// Writes report.html from the other files in the folder (plan_record.h); returns its path.
std::filesystem::path write_report(const std::filesystem::path& folder);

}  // namespace fjr
