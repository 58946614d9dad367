// Improves a certified motion so that errors of the arm's parameters disturb it less.
#pragma once

#include "planner/search/findings.h"

namespace fjr {

// Returns the problem that is searched first: without the terms of the closed loop, which depend on the whole motion at
// once.
Problem without_closed_loop(const Problem& asked);

// If the objective contains the expected tracking error, improves the best motion of the other terms until a round
// lowers the whole objective by less than a thousandth, as it predicted, or three rounds in a row do. In every round
// the tracking error is linearised about the present motion (certificate/robust/tracking_error.h), and a quadratic term
// keeps the next one near it, with a weight that depends on how well the last prediction held (Levenberg and
// Marquardt). The result of a round is kept if it is certified and lowers the requested objective; otherwise the motion
// before stays. found.best is stated by the requested objective.
void lower_tracking_error(const Problem& asked, Findings& found, Session& session);

}  // namespace fjr
