// The way from a smoothed friction law to the exact one, or to one nearly as sharp, in steps.
#pragma once

#include <cstddef>

#include "planner/search/attempts.h"
#include "planner/search/continuation_strategy.h"

namespace fjr {

// Result of one step.
enum class StepOutcome {
  kTaken,
  kNoneLeft,  // the last one was taken, or an earlier one failed
  kFailed     // the solutions before it stay, and no step is left
};

// Each step's solution starts the next one, on a mesh refined by its errors. The solution with the least published
// objective (with the exact law) is kept: a sharper law usually helps, but sometimes a step ends in a worse minimum or
// fails. If the objective does not depend on friction or is the largest torque, the last one is.
class Homotopy {
 public:
  // Begins at the present solution.
  Homotopy(const Attempts& attempts, const ContinuationStrategy& strategy);

  // Takes one step, with a loose mesh tolerance.
  StepOutcome take_step(Attempts& attempts, const ContinuationStrategy& strategy);

  // Puts the best solution so far in the place of the last one. The homotopy must not be used any more.
  void keep_best(Attempts& attempts);

 private:
  bool reach(const Smoothing& step, Attempts& attempts, const ContinuationStrategy& strategy);
  void compare(const Attempts& attempts);

  std::size_t next_;  // index of the next step
  Collocated best_;   // solution so far
  int best_at_;       // value of Attempts::solutions() when it was found
  double least_;      // its objective as it would be published
};

// Reduces the regularisation by effort, which selects among torques, until it is small beside the objective. It would
// outweigh an objective that is much smaller than its weights suggest.
Completion fade_regularisation(Attempts& attempts, const ContinuationStrategy& strategy);

}  // namespace fjr
