// Two plans on one page.
#pragma once

#include <string>

#include "planner/results/report/plan_record.h"

namespace fjr {

// HTML that needs nothing but itself: both motions over one another, and their figures side by side. Throws InputError
// for a plan without a trajectory.
std::string both_plans_page(const PlanRecord& first, const PlanRecord& second);

}  // namespace fjr
