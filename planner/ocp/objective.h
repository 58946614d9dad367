// What a published trajectory costs, term by term.
#pragma once

#include <map>
#include <string>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Every term of the objective, unweighted, in its own unit: of the published rows, with the exact friction law that is
// in their torque. torque_rate is the motion's, and infinite when u jumps: it is then not part of the objective.
// tracking is the closed loop's, and there only where it counts.
std::map<std::string, double> objective_terms(const Problem& problem, const Collocated& solution,
                                              const Trajectory& trajectory);

// Of any rows, whoever made them: all terms but those that rows alone do not determine (torque_rate, tip_speed).
std::map<std::string, double> terms_of_rows(const Parameters& robot, const Trajectory& rows);

double weighted_sum(const Weights& weights, const std::map<std::string, double>& terms);

// The objective of the solution as it would be published.
double published_objective(const Problem& problem, const Collocated& solution);

}  // namespace fjr
