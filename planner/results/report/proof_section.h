// What is certain of the motion, where a proof was asked for.
#pragma once

#include "common/chart_page.h"
#include "planner/results/json_field.h"

namespace fjr {

// certificate: of plan.json. Adds nothing where it has no proof.
void add_proof(ChartPage& page, const JsonField& certificate);

}  // namespace fjr
