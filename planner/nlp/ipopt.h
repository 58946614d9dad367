// Solves an Nlp by Ipopt. Only ipopt.cc includes Ipopt's headers.
#pragma once

#include "planner/nlp/solve.h"

namespace fjr {

// Not thread-safe with MUMPS as Debian builds it; see solve() in solve.h.
SolveReport solve_by_ipopt(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

}  // namespace fjr
