// From collocation polynomials to the rows that are published.
#pragma once

#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Half a count of the link encoder is 5e-5 rad; the slowest motor forgets a velocity error within 0.14 s (J1/B1), and
// hundreds of rows seldom all err to one side.
inline constexpr double kRowVelocityError = 1e-4;  // [rad/s]

// Rows at multiples of the problem's sample period and at the end; between them, where linear interpolation would miss
// the torque's impulse, pairs of rows kJumpSpacing apart: at its jumps (three rows where one falls on a multiple), and
// as many as its fast passages through the friction law need, 10 us apart at the fastest. tau_m = u +
// tau_fm_nonlinear(dtheta) with the exact law, held to the torque limits. velocity_error: what each of those may miss,
// as a velocity of its motor [rad/s].
Trajectory sample(const Problem& problem, const Motion& motion, double velocity_error = kRowVelocityError);

}  // namespace fjr
