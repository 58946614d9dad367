// The file that `fjr request` keeps in its results' folder beside the plan.
#pragma once

#include <filesystem>

#include "planner/protocol/messages.h"

namespace fjr {

// The file trajectory.id holds the id under which the service planned the trajectory; it is needed to execute it later.
void write_trajectory_id(const RequestId& id, const std::filesystem::path& folder);
RequestId read_trajectory_id(const std::filesystem::path& folder);  // throws InputError if there is none

}  // namespace fjr
