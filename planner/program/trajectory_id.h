// What `fjr request` keeps in its results' folder beside the plan.
#pragma once

#include <filesystem>

#include "planner/protocol/messages.h"

namespace fjr {

// The id under which the service planned it, by which it is executed later: file trajectory.id.
void write_trajectory_id(const RequestId& id, const std::filesystem::path& folder);
RequestId read_trajectory_id(const std::filesystem::path& folder);  // InputError: there is none

}  // namespace fjr
