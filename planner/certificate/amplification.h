// Finds where the arm itself amplifies errors, so that no open-loop run across these stretches can be exact.
#pragma once

#include <vector>

#include "model/parameters.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// Returns the rate [1/s] at which the arm, in equilibrium at q with its motors free to turn against viscous friction,
// leaves q under gravity: the largest real root s of det(M s^2 + D s + dG/dq + K (J s^2 + B s) (J s^2 + B s + K)^-1).
// Returns 0 if gravity holds the arm there.
double gravity_growth_rate(const Parameters& p, const Joints<double>& q);

// Returns the stretches of the plan across which an open-loop run need not be exact, in the order of their ends. There
// are two reasons:
// - The motor stays for more than 0.1 s in the unstable band of a friction law that falls with speed at rest, as that
//   of joint 2 does. The stretch lasts from the beginning to the end of the stay.
// - Gravity amplifies errors near the upright. The stretch is the instant (from = to) at which the integral of
//   gravity_growth_rate since the start, or since the last such instant, exceeds 3: an error made before has then grown
//   e^3 = 20-fold.
std::vector<Stretch> stretches_of_amplification(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
