// Ipopt behind the Nlp seam: the only file that knows it is ipopt.cc.
#pragma once

#include "planner/nlp/solve.h"

namespace fjr {

// Not thread-safe: Debian's MUMPS is not.
SolveReport solve_by_ipopt(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

}  // namespace fjr
