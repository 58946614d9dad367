// Motions take the steps of the homotopy in friction side by side. After each step those are dropped that are the same
// as another one, or too far above the best to become better than it.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "planner/search/continuation.h"
#include "planner/search/session.h"

namespace fjr {

// Scaled objectives of all motions so far after each homotopy step, by the width of its friction law [rad/s] and its
// regularisation.
using StepObjectives = std::map<std::pair<double, double>, std::vector<double>>;

struct Raced {
  std::vector<Continuation> arrived;  // motions that finished their homotopy, settled and usable
  std::vector<Continuation> dropped;  // the best first
};

// Returns whether a motion with this objective after a step to this width [rad/s] is worth following, given the
// objectives of motions found before it. It is not if one of them is the same minimum, or better by more than the steps
// that are left have been seen to make up.
bool worth_following(double objective, double width, const std::vector<double>& others, bool sees_friction,
                     const RaceSettings& settings);

// Runs the race. motions: in the order in which they were found. reached: results of earlier races, to which those of
// this race are added.
Raced race(std::vector<Continuation> motions, StepObjectives& reached, Session& session);

}  // namespace fjr
