// Limits hold at the collocation points by construction; between them they are made to hold by margins.
#pragma once

#include <vector>

#include "planner/collocation/motion.h"
#include "planner/problem/problem.h"

namespace fjr {

// By how much each limit, less a part of the back-off, is exceeded on each interval of the motion between and at the
// collocation points, with the exact friction law (0 where it is not). Same units and order as the limits. A torque
// that passes the friction law's step counts with the whole step, wherever in the interval that falls.
std::vector<Limits> excesses(const Problem& problem, const Motion& motion);

// Adds the excesses to the margins (empty: none so far), a little enlarged so that the next solution is inside.
// False when there was nothing to add.
bool widen(std::vector<Limits>& margins, const std::vector<Limits>& excesses);

}  // namespace fjr
