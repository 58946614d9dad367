// Problems whose optimum is the least change that makes a request feasible. The request is relaxed by a slack (Slack in
// problem/problem.h), which is minimised. One such problem replaces a search over a dozen values of a limit, most of
// which have no solution.
#pragma once

#include "planner/problem/problem.h"
#include "planner/problem/relaxable.h"
#include "planner/search/settings.h"

namespace fjr {

// Returns the problem whose objective is the least change of that one thing, with time as regularisation. A slack of
// one relaxes it by its size.
Problem with_slack(const Problem& problem, const Relaxable& what, const SlackSettings& settings);

// Does the same with everything but velocities relaxed at once; the slack is a fraction of the size of each.
Problem with_slack_everywhere(const Problem& problem, const SlackSettings& settings);

// Returns the problem with a larger weight of time, so that the first solution has a bounded duration.
Problem with_larger_time_weight(Problem with_slack, const SlackSettings& settings);

// Returns the value that a slack of with_slack(problem, what) means, counted as Relaxable::from is.
double value_with(const Problem& problem, const Relaxable& what, double slack);

}  // namespace fjr
