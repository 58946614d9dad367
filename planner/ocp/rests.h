// Adapts a solution as the start for a sharper or smoother friction law.
#pragma once

#include "planner/ocp/collocate.h"

namespace fjr {

// Returns the solution with the velocities of resting motors scaled to the friction law of `width` [rad/s]; all else
// stays. With a smoothed law, a resting motor creeps at the velocity at which friction balances the load, which is
// proportional to the width of the law. At the same velocity, a law of a third of the width would already give almost
// the full friction torque, and the torques of the start would be far off.
Collocated with_rests_scaled(const Problem& problem, Collocated solution, double width);

}  // namespace fjr
