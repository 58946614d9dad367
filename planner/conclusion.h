// Draws the conclusion of a search: the status of its plan, and the reason if that is not certified.
#pragma once

#include "planner/plan.h"
#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// Sets status and reason. plan: has the published motion, and as far as known why there is none.
void conclude(const Findings& found, Session& session, Plan& plan);

}  // namespace fjr
