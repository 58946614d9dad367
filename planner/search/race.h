// Motions take the steps of the homotopy in friction side by side. After each step those are dropped that are the same
// as another one, or too far above the best to become better than it.
#pragma once

#include <map>
#include <vector>

#include "planner/search/continuation.h"
#include "planner/search/session.h"

namespace fjr {

// What steps came to, of all motions so far: objectives as they were optimised, by the width of the friction law
// [rad/s].
using StepObjectives = std::map<double, std::vector<double>>;

struct Raced {
  std::vector<Continuation> arrived;  // as far as their homotopy goes; settled, and usable
  std::vector<Continuation> dropped;  // the best first
};

// Whether a motion whose objective was `objective` after a step is worth following, beside what others, found before,
// came to after that step: not when one of them is the same minimum, or better by more than the steps that are left
// have been seen to make up.
bool worth_following(double objective, double width, const std::vector<double>& others, bool sees_friction);

// In the order in which they were found. `reached` is what earlier races came to; what this one comes to is added.
Raced race(std::vector<Continuation> motions, StepObjectives& reached, Session& session);

}  // namespace fjr
