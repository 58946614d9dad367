// The folder that a command puts results into, and what is in it beside the plan's files
// (planner/results/report/plan_files.h).
#pragma once

#include <filesystem>
#include <string>

#include "planner/plan.h"

namespace fjr {

// Makes the folder and checks, before anything is planned, whether results can be stored there. Throws InputError if
// not. Results of an earlier run stay until there are new ones.
void prepare_folder(const std::filesystem::path& folder);

// Returns a sentence on where the results are that those with `status` have replaced; empty if there are none. kept: as
// NewResults::publish() returns it.
std::string about_previous(const std::filesystem::path& folder, PlanStatus status, bool kept);

bool has_report(const std::filesystem::path& folder);

}  // namespace fjr
