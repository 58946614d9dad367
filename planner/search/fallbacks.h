// What is tried, in this order, when no start leads anywhere.
//
// Before it come more starts, displaced at random, and the fastest motion stretched to the time there is (motions.cc);
// within a continuation a warm start that failed is tried again with an adaptive barrier (continuation.cc).
#pragma once

#include <memory>
#include <optional>

#include "planner/search/continuation.h"

namespace fjr {

// Whether the arm could be moved slowly along the straight way, without swinging.
bool can_be_carried(const Problem& problem);

// Where it cannot, it has to be swung up. With limits that carry it a motion is soon found; those are tightened step by
// step, each solution starting the next, and the motion comes to swing by itself, the more the tighter they are.
// Where much torque is missing, the least torque for a motion that folds link 2 on the way is asked for instead.
// Motions of more than `longest` [s] are not followed. With more than the usual patience, what only a smoothed friction
// law lifts is searched again with a sharper one.
struct SwungUp {
  std::optional<Continuation> motion;  // as good as Continuation::begin() leaves it
  std::optional<Limits> reached;       // the tightest limits with which there was one, or is likely to be
};
SwungUp swing_up(const std::shared_ptr<const Problem>& problem, double longest, Session& session);

// The first starts again with patience and more effort, a coarser mesh, a finer one, and then relaxation: with
// its limits relaxed the problem is solved, and they are tightened again step by step, each solution starting the next.
// What was tried is counted in Session::fallbacks(). The result is as good as Continuation::begin() leaves it; none
// when nothing led anywhere.
std::optional<Continuation> fall_back(const std::shared_ptr<const Problem>& problem, Session& session);

}  // namespace fjr
