// Two plans on one page.
#pragma once

#include <string>

#include "planner/results/report/plan_record.h"

namespace fjr {

// Returns self-contained HTML with both motions drawn over each other and their figures side by side. Throws InputError
// for a plan without a trajectory.
std::string both_plans_page(const PlanRecord& first, const PlanRecord& second);

}  // namespace fjr
