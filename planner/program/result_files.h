// The files of a planned request, the same however it was planned.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "planner/plan.h"
#include "planner/protocol/messages.h"

namespace fjr {

// Makes the folder, and finds out before anything is planned whether results can be stored there. InputError: they
// cannot. Results of an earlier run stay until there are others.
void prepare_folder(const std::filesystem::path& folder);

// report.html from the other files in the folder (planner/results/report/plan_record.h); returns its path.
std::filesystem::path write_report(const std::filesystem::path& folder);
// One sentence on where the results are that those with `status` have replaced; empty where there are none. kept: as
// NewResults::publish() says.
std::string about_previous(const std::filesystem::path& folder, PlanStatus status, bool kept);

bool has_report(const std::filesystem::path& folder);

// The id under which the service planned it, by which it is executed later: file trajectory.id.
void write_trajectory_id(const RequestId& id, const std::filesystem::path& folder);
RequestId read_trajectory_id(const std::filesystem::path& folder);  // InputError: there is none

// So that a trajectory file says by itself what it is for: request, robot, payload, tightened limits, as plan.json has
// them.
void describe(Trajectory& trajectory, const nlohmann::ordered_json& plan);

}  // namespace fjr
