// Problems whose optimum is the least change that makes a request possible: what may change is relaxed by a slack
// (Slack in problem/problem.h), and the slack is minimised. One such problem answers what a search over values of the
// limit would take a dozen for, most of them without a solution.
#pragma once

#include "planner/problem/problem.h"
#include "planner/problem/relaxable.h"

namespace fjr {

// By how much a slack of one relaxes it, in its unit.
double size_of(const Relaxable& what);

// The problem with the least change of that one thing as its objective, beside a regularisation by time.
Problem with_slack(const Problem& problem, const Relaxable& what);

// The same with everything but velocities relaxed at once, each in proportion to its size. [fractions of it]
Problem with_slack_everywhere(const Problem& problem);

// Fraction by which limits are relaxed for the duration that such a problem starts from.
inline constexpr double kLoose = 3;

// The same with a larger weight of time, so that the first solution has a bounded duration.
Problem with_larger_time_weight(Problem with_slack);

// Its value when it is relaxed by that slack of with_slack(problem, what), counted as Relaxable::from is.
double value_with(const Problem& problem, const Relaxable& what, double slack);

}  // namespace fjr
