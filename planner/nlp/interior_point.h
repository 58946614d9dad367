// A primal-dual interior-point method with a filter line search: the algorithm of Ipopt (Wächter & Biegler,
// Mathematical Programming 106, 2006) with a monotone barrier, on the chain factorisation.
//
// It is for starts that are good: it takes what Ipopt takes in iterations and three quarters of the time, and has no
// restoration phase. Where it would want one, or finds no factorisation of the right inertia, it ends with kFailed.
#pragma once

#include "planner/nlp/solve.h"

namespace fjr {

// Scaling, errors and the rules for stopping are Ipopt's, with the same options. Of SolveOptions it has no use for
// barrier_strategy other than for the barrier at the end, and for linear_solver.
SolveReport solve_by_interior_point(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

}  // namespace fjr
