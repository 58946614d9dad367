// Settings of a continuation for one kind of motion.
#pragma once

#include <optional>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/problem/problem.h"

namespace fjr {

struct ContinuationStrategy {
  std::vector<Smoothing> steps;           // of the homotopy, from the first solution's friction law to the last one
  bool loose_steps = false;               // homotopy steps are solved with loose tolerances
  bool fades = true;                      // a regularisation that outweighs the objective is reduced at the end
  bool begins_afresh = true;              // a failed warm start on a finer mesh is repeated without multipliers
  double mesh = 1;                        // factor on the mesh tolerance
  std::optional<double> worth_splitting;  // on the mesh that is to be certified, instead of excess_worth_splitting
};

// Returns the strategy of all motions but those that swing up; its homotopy steps depend on the objective.
ContinuationStrategy usual_strategy(const Problem& problem);

// Returns the strategy of minimum-time swing-ups with hardly any torque to spare, whose time changes little near the
// optimum.
ContinuationStrategy swinging_strategy();

}  // namespace fjr
