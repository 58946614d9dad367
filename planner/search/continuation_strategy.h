// How a continuation goes about one kind of motion, from its first solution to the certificate.
#pragma once

#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"

namespace fjr {

// Fraction of a limit beyond which a margin would usually cost more than intervals.
inline constexpr double kExcessWorthSplitting = 0.02;

struct ContinuationStrategy {
  std::vector<Smoothing> steps;  // of the homotopy, from the first solution's friction law to the exact one
  bool loose_steps = false;      // steps that others follow are solved loosely
  bool fades = true;             // a regularisation that outweighs the objective is reduced at the end
  bool begins_afresh = true;     // where a warm start fails on a finer mesh, the multipliers are forgotten
  double mesh = 1;               // tolerance of the mesh, times the usual one
  double worth_splitting = kExcessWorthSplitting;  // on the mesh that is to be certified
};

// The usual one.
ContinuationStrategy usual_strategy(const Problem& problem);

// Of a motion that swings with hardly any torque to spare, whose time changes little near the optimum.
ContinuationStrategy swinging_strategy();

}  // namespace fjr
