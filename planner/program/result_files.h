// The folder that a command puts results into, and what is in it beside the plan's files
// (planner/results/report/plan_files.h).
#pragma once

#include <filesystem>
#include <string>

#include "planner/plan.h"

namespace fjr {

// Makes the folder, and finds out before anything is planned whether results can be stored there. InputError: they
// cannot. Results of an earlier run stay until there are others.
void prepare_folder(const std::filesystem::path& folder);

// One sentence on where the results are that those with `status` have replaced; empty where there are none. kept: as
// NewResults::publish() says.
std::string about_previous(const std::filesystem::path& folder, PlanStatus status, bool kept);

bool has_report(const std::filesystem::path& folder);

}  // namespace fjr
