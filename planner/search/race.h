// Motions that are followed through the homotopy in friction side by side, each with the same step at a time: one that
// is no better than another, or will not be the best any more, is dropped on the way.
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
