// Why a request cannot be had, in physical terms: what is in the way, when, and the least that would have to change.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/continuation.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/guesses.h"

namespace fjr {

// Why a request has no plan: it cannot have one; or it can, and from this motion it should be found; or it is not
// known.
struct WhyNot {
  std::optional<Infeasibility> infeasibility;
  std::optional<Guess> start;
};

// problem: what no motion was found for. `fastest`: the solution of fastest_of(problem), null if there is none.
// certified: whether its rows are exact enough to be published; otherwise its duration is told as about what it takes.
// reached: limits with which a motion was found on the way, on a coarse mesh; none where that was not tried.
WhyNot explain(const Problem& problem, const Continuation* fastest, bool certified,
               const std::optional<Limits>& reached, Session& session);

}  // namespace fjr
