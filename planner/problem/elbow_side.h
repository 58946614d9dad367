// Decides by geometry, before anything is solved, whether the task lets the elbow change sides.
#pragma once

#include <optional>
#include <string>

#include "planner/problem/problem.h"

namespace fjr {

// If the tip is kept to a line, an arc or a box, the elbow can change sides only where the arm can be stretched out (q2
// passes an even multiple of pi) or folded (an odd one), that is where the region touches the edge of the arm's reach.
// Returns a sentence that says why start, via points and goal cannot be joined, if geometry excludes it.
std::optional<std::string> barred_elbow(const Problem& problem);

}  // namespace fjr
