// A primal-dual interior-point method with a filter line search: the algorithm of Ipopt (Wächter & Biegler,
// Mathematical Programming 106, 2006) with a monotone barrier, on the chain factorisation.
//
// Started from a solution, it takes as many iterations as Ipopt, and three quarters of the time. Started from a guess,
// it takes about half the time, but often reaches another minimum. It has no restoration phase: where it would need
// one, or cannot correct the inertia of the KKT matrix, it ends with kFailed.
#pragma once

#include "planner/nlp/solve.h"

namespace fjr {

// Scaling, error measures and termination rules are those of Ipopt, with the same options. linear_solver is ignored.
// barrier_strategy decides about the final barrier parameter, and if the initial one is no larger, the method begins
// with the final one.
SolveReport solve_by_interior_point(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

}  // namespace fjr
