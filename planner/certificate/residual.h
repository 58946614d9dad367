// What the arm does after the end of a trajectory that ends at rest.
#pragma once

#include "planner/certificate/certificate.h"

namespace fjr {

// The row is an equilibrium: dq = dtheta = 0 and theta = q + K^-1 G(q), to 1e-5 rad and rad/s.
bool is_at_rest(const Parameters& p, const Sample& row);

// How far the links come off the rest at `goal` within the window of Residual, held there by the executor's feedback,
// with its ticks and the counts of the encoders. [rad]
Joints<double> deviation_at_rest(const Parameters& p, const Sample& goal, const State<double>& from);

// Holds G(q_goal) for one second from the states in which the rollouts ended, with and without feedback to the rest at
// q_goal. A breakdown of the open-loop integration leaves the drift reached so far.
Residual roll_out_residual(const Parameters& p, const Sample& goal, const State<double>& closed_loop_end,
                           const State<double>& open_loop_end);

}  // namespace fjr
