// Where the arm itself amplifies errors, so that no open-loop run across it can be exact.
#pragma once

#include <vector>

#include "model/parameters.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// Rate at which the arm, in equilibrium at q with its motors free to turn against viscous friction, leaves q under
// gravity: the largest real root s of det(M s^2 + D s + dG/dq + K (J s^2 + B s) (J s^2 + B s + K)^-1). 0 where gravity
// holds it. [1/s]
double gravity_growth_rate(const Parameters& p, const Joints<double>& q);

// Every stretch of the plan across which an open-loop run need not be exact, in the order of their ends. Two reasons:
// - a motor whose friction law falls with speed at rest (joint 2's) stays in its unstable band for more than 0.1 s:
// from
//   the beginning to the end of each such stay;
// - gravity amplifies near the upright: the instant (from = to) at which the integral of gravity_growth_rate since the
//   start, or since the last such instant, exceeds 3. An error made before has then grown e^3 = 20-fold.
std::vector<Stretch> stretches_of_amplification(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
