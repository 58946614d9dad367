// Adapts mesh and margins to a solution, until every limit holds between the collocation points.
#pragma once

#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/search/attempts.h"
#include "planner/search/continuation_strategy.h"

namespace fjr {

// Solves again with finer intervals and margins until the mesh is good enough and every limit holds between the
// collocation points too. failures: number of rounds that found no solution, of this and earlier calls.
Completion tighten(Attempts& attempts, const ContinuationStrategy& strategy, int& failures);

// Moves nodes to their optimal times and tightens, more than once if the refined mesh needs some nodes elsewhere again.
Completion tighten_on_moved_nodes(Attempts& attempts, const ContinuationStrategy& strategy, int& failures);

// Splits the intervals whose errors [rad] exceed the mesh tolerance or make up most of their sum, and those that exceed
// limits by much, and solves again.
ChangeOutcome split_by_errors(const std::vector<double>& errors, Attempts& attempts,
                              const ContinuationStrategy& strategy);

// Widens margins where the published rows exceed limits, and solves again.
ChangeOutcome widen_by_checks(const std::vector<LimitCheck>& checks, Attempts& attempts);

// Widens the margins of limits that the rollout exceeds, on all intervals by as much, and solves again. Errors of the
// rollout move along the motion with every solution, and so would margins on a few intervals.
ChangeOutcome widen_by_rollout(const std::vector<LimitCheck>& checks, Attempts& attempts);

// Solves again with motors kept moving where their rest would be unstable (creep.h).
ChangeOutcome keep_motors_moving(Attempts& attempts, double shortest_rest);

}  // namespace fjr
