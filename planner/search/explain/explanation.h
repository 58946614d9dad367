// An explanation while it is made. Its parts (reasons.h) share it.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/explain/explain.h"
#include "planner/search/explain/relaxation.h"
#include "planner/search/guesses.h"
#include "planner/search/search.h"
#include "planner/search/session.h"

namespace fjr {

struct Explanation {
  Explanation(const Problem& request, const Known& found, Session& of)
      : problem(request), known(found), session(of), search(of) {}

  // Returns the shortest duration [s]; known.fastest must not be null.
  double shortest() const { return known.fastest->solution().motion.duration(); }

  // Returns whether even the fastest motion takes longer than is allowed.
  bool is_too_short() const { return known.fastest != nullptr && shortest() > problem.duration.max; }

  const Problem& problem;
  const Known& known;
  Session& session;
  Search search;
  Infeasibility result{};
  bool anything_tried = false;   // whether relaxing anything was tried
  std::optional<Guess> start{};  // of a motion for the request, which turned out to be possible
};

// Fraction of a change that is added to it: the least change leaves exactly one feasible motion, which cannot be
// refined or given margins.
inline constexpr double kRelaxationMargin = 0.01;
// Factors on the least change, tried in this order until planning succeeds.
inline constexpr double kRetryFactors[] = {1, 1.03, 1.1, 1.25, 1.5, 2};
inline constexpr double kSlackWorthExactFriction =
    0.05;                                         // slack of a sketch below which an exact solution may need none
inline constexpr double kNegligibleSlack = 2e-3;  // below it the request is possible, as far as a sketch can tell

inline constexpr double kDurationMargin = 2e-4;  // fraction of a shortest duration

// Returns the shortest duration [s] as it is reported: rounded up and with a little to spare, so that a request for it
// has a plan.
double rounded_up(double duration);

}  // namespace fjr
