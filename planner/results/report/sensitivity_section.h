// The section about the limits that restrict the motion, and their shadow prices.
#pragma once

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// plan: plan.json with a `sensitivity`.
void add_sensitivity(ChartPage& page, const JsonField& plan);

}  // namespace fjr
