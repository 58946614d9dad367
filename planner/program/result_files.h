// The files of a planned request, the same however it was planned.
#pragma once

#include <filesystem>
#include <string>

#include "planner/plan.h"
#include "planner/service/messages.h"

namespace fjr {

// Makes the folder and removes results of an earlier run, which must not be taken for this one's whatever becomes of
// it.
void prepare_folder(const std::filesystem::path& folder);

// report.html from the other files in the folder (planner/report/plan_record.h); returns its path.
std::filesystem::path write_report(const std::filesystem::path& folder);
bool has_report(const std::filesystem::path& folder);

// The id under which the service planned it, by which it is executed later: file trajectory.id.
void write_trajectory_id(const RequestId& id, const std::filesystem::path& folder);
RequestId read_trajectory_id(const std::filesystem::path& folder);  // InputError: there is none

// So that a trajectory file says by itself what it is for.
void describe(Trajectory& trajectory, const std::string& request, const std::string& request_hash,
              const std::string& robot_hash, PlanStatus status);

}  // namespace fjr
