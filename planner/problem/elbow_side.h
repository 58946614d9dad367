// Which side the elbow is on, and whether the task lets it change: decided by geometry, before anything is solved.
#pragma once

#include <string>

#include "planner/problem/problem.h"

namespace fjr {

// With the tip kept to a line, an arc or a box the elbow changes sides only where the arm can be stretched out (q2
// passes an even multiple of pi) or folded (an odd one), that is where the region touches the edge of the arm's reach.
// A sentence that says why start, via points and goal cannot be joined then; empty where nothing speaks against it.
std::string barred_elbow(const Problem& problem);

}  // namespace fjr
