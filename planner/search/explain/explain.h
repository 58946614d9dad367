// Why a request cannot be had, in physical terms: what is in the way, when, and the least that would have to change.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/continuation.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/guesses.h"
#include "planner/search/out_of_reach.h"

namespace fjr {

// Why a request has no plan: it cannot have one; or it can, and from this motion it should be found; or it is not
// known.
struct WhyNot {
  std::optional<Infeasibility> infeasibility;
  std::optional<Guess> start;
};

// What the search came to before it was asked why.
struct Known {
  const Continuation* fastest = nullptr;  // the solution of fastest_of(problem); null if there is none
  bool certified = false;                 // its rows are exact enough; else its duration is told as about what it takes
  std::optional<Limits> reached;          // with which a motion was found on the way, on a coarse mesh
  std::optional<OutOfReach> out_of_reach;  // clearly
  bool start_failed = false;  // explain() has returned a start, from which planning failed: it is to tell a relaxation
};

// problem: what no motion was found for.
WhyNot explain(const Problem& problem, const Known& known, Session& session);

}  // namespace fjr
