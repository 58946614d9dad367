// Copies the results of a search into a plan: the motion that was published, and the account of how it was found.
#pragma once

#include "planner/plan.h"
#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// Copies the best published motion, certified or not, if there is one.
void tell_motion(const Findings& found, Plan& plan);

// Sets what knowing each parameter twice as well would give back of the cost of margins: the reduction of margins,
// averaged over the time in which a limit is active, times the limit's shadow price.
void tell_savings(const Analysis& analysis, Robustness& robustness);

void tell_account(const Findings& found, const Account& account, Plan& plan);

}  // namespace fjr
