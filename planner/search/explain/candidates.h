// Finds out which limits may make a request infeasible, from motions that come near to it.
#pragma once

#include <optional>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/search/continuation.h"
#include "planner/search/settings.h"

namespace fjr {

// Something to relax, with when it is in the way, where that is known.
struct Candidate {
  Relaxable what;
  std::optional<double> time;  // [s]
  // How much it is in the way, compared to others. Of active_in(): what it takes off the shortest duration [s] at
  // first, by its size.
  double weight = 0;
};

// Returns the limits that the fastest motion depends on, by their multipliers; those with the largest effect come
// first.
std::vector<Candidate> active_in(const Continuation& fastest, const ExplanationSettings& settings);

// Returns the velocities that are asked for, and then the limits that a motion exceeds which was found with everything
// relaxed; those exceeded most come first. everything: that motion; null: there is none.
std::vector<Candidate> candidates(const Problem& problem, const Continuation* everything,
                                  const ExplanationSettings& settings);

// Returns when the motion exceeds the limit most [s]; nothing if it does not.
std::optional<double> worst_moment(const Problem& problem, const Relaxable& what, const Collocated& solution);

}  // namespace fjr
