// What of a search a plan tells: the motion that was published, and the account of how it was found.
#pragma once

#include "planner/plan.h"
#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// What was published best, certified or not; nothing where nothing was.
void tell_motion(const Findings& found, Plan& plan);

// What knowing each parameter twice as well would give back of what margins cost: smaller margins, in the mean over the
// time in which a limit is active, times what a unit more of it is worth.
void tell_savings(const Analysis& analysis, Robustness& robustness);

void tell_account(const Findings& found, const Account& account, Plan& plan);

}  // namespace fjr
