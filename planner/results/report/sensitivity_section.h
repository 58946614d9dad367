// What limits the motion, and what more of it would be worth.
#pragma once

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// plan: plan.json with a `sensitivity`.
void add_sensitivity(ChartPage& page, const JsonField& plan);

}  // namespace fjr
