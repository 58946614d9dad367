// What may be in the way of a request, by what motions say that come near to it.
#pragma once

#include <optional>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/search/continuation.h"

namespace fjr {

// Something to relax, with when it is in the way, where that is known.
struct Candidate {
  Relaxable what;
  std::optional<double> time;  // [s]
  double weight = 0;           // how much it is in the way, compared to others
};

// What the fastest motion is limited by, by the multipliers; what helps most first.
std::vector<Candidate> active_in(const Continuation& fastest);

// Velocities that are asked for; then what a motion exceeds that was found with everything relaxed (null: there is
// none), what it exceeds most first.
std::vector<Candidate> candidates(const Problem& problem, const Continuation* everything);

// When the motion exceeds the limit most [s]; none where it does not.
std::optional<double> worst_moment(const Problem& problem, const Relaxable& what, const Collocated& solution);

}  // namespace fjr
