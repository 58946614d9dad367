// The keys of a request whose values a problem takes over as they are. The hash and plan.json go by this list. States,
// limits, the objective and the task are resolved first, and have lists of their own.
#pragma once

#include "planner/problem/problem.h"

namespace fjr {

// Calls visit(key, value, in_hash). in_hash: a key that came after the first version is in the hash of a request only
// if it differs from the default, so that older requests keep theirs.
template <class Visit>
void visit_settings(const Problem& problem, Visit&& visit) {
  visit("sample_period", problem.sample_period, true);
  visit("seed", problem.seed, true);
  visit("search", problem.search, problem.search != Thoroughness::kDefault);
  visit("method", problem.method, problem.method != kDefaultMethod);
  visit("robust", problem.robust, problem.robust.has_value());
  visit("proven", problem.proven, problem.proven);
}

}  // namespace fjr
