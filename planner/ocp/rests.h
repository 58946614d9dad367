// A solution as the start for another friction law.
#pragma once

#include "planner/ocp/collocate.h"

namespace fjr {

// A motor that rests in a smoothed friction law creeps, at the speed at which friction carries the load: in proportion
// to the law's width. With that speed kept, a law of a third of the width would carry hardly less than its most, and
// the torques would be far off. This is the solution with the velocities of what rests scaled to the law of `width`
// [rad/s]; everything else stays.
Collocated with_rests_scaled(const Problem& problem, Collocated solution, double width);

}  // namespace fjr
