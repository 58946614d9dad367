// What a published trajectory costs, term by term.
#pragma once

#include <map>
#include <string>

#include "planner/collocation/motion.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Every term of Weights, unweighted, in its own unit; from the published rows, except torque_rate, which is the
// motion's (and infinite when u jumps: it is then not part of the objective).
std::map<std::string, double> objective_terms(const Problem& problem, const Motion& motion,
                                              const Trajectory& trajectory);

double weighted_sum(const Weights& weights, const std::map<std::string, double>& terms);

// The objective of the motion as it would be published: sampled, with the exact friction law.
double published_objective(const Problem& problem, const Motion& motion);

}  // namespace fjr
