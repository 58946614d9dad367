// Where the arm itself amplifies errors, so that no open-loop run can be exact.
#pragma once

#include <string>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Rate at which the arm, in equilibrium at q with its motors free to turn against viscous friction, leaves q under
// gravity: the largest real root s of det(M s^2 + D s + dG/dq + K (J s^2 + B s) (J s^2 + B s + K)^-1). 0 where gravity
// holds it. [1/s]
double gravity_growth_rate(const Parameters& p, const Pair<double>& q);

// Why an open-loop run of this plan need not be exact, one sentence; empty when it must be. Two reasons:
// - a motor whose friction law falls with speed at rest (joint 2's) stays in its unstable band for more than 0.1 s;
// - the plan stays near the upright so long that the integral of gravity_growth_rate over it exceeds 3: an error made
//   before has then grown e^3 = 20-fold by gravity alone.
std::string why_open_loop_cannot_be_exact(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
