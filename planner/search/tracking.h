// A certified motion traded for one that errors of the arm's parameters disturb less.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// The problem that is searched first: without the terms of the closed loop, which see the whole motion at once.
Problem without_closed_loop(const Problem& asked);

// Where the objective prices the expected tracking error: from the best motion of the other terms to one at which the
// whole objective is no longer lowered by more than a thousandth. In every round the price is linearised about the
// motion there is (certificate/robust/tracking_error.h) and held near it by a quadratic, whose weight follows how well
// the last prediction held (Levenberg and Marquardt); a round's motion is taken where it is certified and lowers the
// objective that was asked for, and otherwise the one before stays. What found.best says is by that objective.
void lower_tracking_error(const Problem& asked, Findings& found, Session& session);

}  // namespace fjr
