// The section about the proof of the motion, if one was requested.
#pragma once

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// certificate: the field of plan.json. Adds nothing if it contains no proof.
void add_proof(ChartPage& page, const JsonField& certificate);

}  // namespace fjr
