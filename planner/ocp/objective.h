// Evaluates the terms of the objective on a published trajectory.
#pragma once

#include <map>
#include <string>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Returns every term of the objective by name, without its weight and in its own unit, computed from the published
// samples (whose torque contains the exact friction law). torque_rate is computed from the motion and is infinite if u
// jumps; it is then not part of the objective. tracking needs closed-loop rollouts and is included only if it has a
// weight.
std::map<std::string, double> objective_terms(const Problem& problem, const Collocated& solution,
                                              const Trajectory& trajectory);

// Returns the terms of any trajectory, except for those that samples alone do not determine (torque_rate, tip_speed)
// and those of the closed loop.
std::map<std::string, double> terms_of_rows(const Parameters& robot, const Trajectory& rows);

// Returns the sum of the terms that have a weight, times their weights. Throws std::out_of_range if one is missing.
double weighted_sum(const Weights& weights, const std::map<std::string, double>& terms);

// Returns the weighted objective of the trajectory that would be published for the solution.
double published_objective(const Problem& problem, const Collocated& solution);

}  // namespace fjr
