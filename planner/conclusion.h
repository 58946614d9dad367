// What a search comes to: the status of its plan, and the reason where that is not certified.
#pragma once

#include "planner/plan.h"
#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// plan: with the motion that was published, and why there is none, as far as that is known.
void conclude(const Findings& found, Session& session, Plan& plan);

}  // namespace fjr
