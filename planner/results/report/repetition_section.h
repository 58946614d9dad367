// The section about what a motion has learnt from its runs.
#pragma once

#include "common/chart_page.h"
#include "model/parameters.h"
#include "planner/results/json_field.h"

namespace fjr {

// Adds the deviations of all runs so far from the plan, and those expected in the next one. Adds nothing if the motion
// has not been corrected.
void add_repetition(ChartPage& page, const JsonField& plan, const Parameters& robot);

}  // namespace fjr
