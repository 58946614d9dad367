// Fallbacks if no start leads to a solution, in the order in which they are tried.
//
// Before them the search tries more starts, displaced at random, and the fastest motion stretched to the time there is
// (motions.cc). Within a continuation, a failed warm start is repeated with an adaptive barrier (attempts.h).
#pragma once

#include <memory>
#include <optional>

#include "planner/search/continuation.h"

namespace fjr {

// Returns whether the limits allow moving the arm slowly along the straight path, without swinging.
bool can_be_carried(const Problem& problem);

// Searches a motion that swings the arm up, if it cannot be carried. Limits are relaxed until it can be, which
// soon gives a motion. They are then tightened step by step, each solution starting the next, and the tighter they are,
// the more the motion swings. If much torque is missing, the search first looks for the least torque of a motion that
// folds link 2 on the way. Motions of more than `longest` [s] are not followed. With more than the usual budget, a
// motion that does not converge with the exact friction law is searched again from a sharper one.
struct SwungUp {
  std::optional<Continuation> motion;  // at least as far as after Continuation::begin()
  std::optional<Limits> reached;       // tightest limits for which a motion was found or is likely
};
SwungUp swing_up(const std::shared_ptr<const Problem>& problem, double longest, Session& session);

// Tries the first starts again with more iterations and more regularisation, a coarser mesh, a finer one, and at last
// relaxed limits, which are tightened step by step, each solution starting the next. Session::fallbacks() counts what
// was tried. Returns a motion as after Continuation::begin(), or nothing if all failed.
std::optional<Continuation> fall_back(const std::shared_ptr<const Problem>& problem, Session& session);

}  // namespace fjr
