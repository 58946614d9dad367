// What a motion has learnt from its runs.
#pragma once

#include "common/chart_page.h"
#include "model/parameters.h"
#include "planner/results/json_field.h"

namespace fjr {

// How far every run so far was off the plan, and what is expected of the next one. Nothing where the plan is as it was
// planned.
void add_repetition(ChartPage& page, const JsonField& plan, const Parameters& robot);

}  // namespace fjr
