// From collocation polynomials to the rows that are published.
#pragma once

#include "planner/collocation/motion.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Rows at multiples of the problem's sample period and at the end; between them, where linear interpolation would miss
// the torque's impulse, pairs of rows kJumpSpacing apart: at its jumps, and as many as its fast passages through the
// friction law need. tau_m = u + tau_fm_nonlinear(dtheta) with the exact law, held to the torque limits.
Trajectory sample(const Problem& problem, const Motion& motion);

}  // namespace fjr
