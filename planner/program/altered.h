// Warns of plans whose rows were edited after they had been certified.
#pragma once

#include <filesystem>

#include "planner/results/report/plan_record.h"

namespace fjr {

// Says on stderr why the rows of a plan that says it is certified are not, by verify() without proof and margins for
// other arms. Says nothing of other plans.
void warn_if_altered(const std::filesystem::path& folder, const PlanRecord& plan);

}  // namespace fjr
