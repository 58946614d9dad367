// Why a request cannot be had, in physical terms: what is in the way, when, and the least that would have to change.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/continuation.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/guesses.h"
#include "planner/search/out_of_reach.h"

namespace fjr {

// Why a request has no plan. Either it is infeasible, or it is feasible and `start` should lead to a plan, or the
// reason is not known (neither is set).
struct WhyNot {
  std::optional<Infeasibility> infeasibility;
  std::optional<Guess> start;
};

// Results of the search before the explanation.
struct Known {
  const Continuation* fastest = nullptr;   // the solution of fastest_of(problem); null if there is none
  bool certified = false;                  // its rows are exact enough; else its duration is reported with "about"
  std::optional<Limits> reached;           // relaxed limits for which a motion was found on a coarse mesh
  std::optional<OutOfReach> out_of_reach;  // clearly
  bool start_failed = false;  // planning failed from a start that explain() returned: a relaxation is wanted
};

// Explains why no motion was found for the problem.
WhyNot explain(const Problem& problem, const Known& known, Session& session);

}  // namespace fjr
