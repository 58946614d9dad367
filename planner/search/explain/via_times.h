// Times of via points that cannot be kept.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/search.h"

namespace fjr {

// When via point i can be passed at the earliest [s], the times of those before it kept and whatever comes after; none
// where no motion there is found.
std::optional<double> earliest_at(const Problem& problem, std::size_t i, Search& search);

struct NearestTime {
  std::optional<double> time;     // [s] none: no other time of this via point helps
  std::optional<Guess> as_asked;  // of a motion that passes it when it is to be passed, which was found from there
};

// The time of via point i alone, moved as little as leaves the rest of the request possible; `least`: known to be the
// least, if it is enough.
NearestTime nearest_time(const Problem& problem, std::size_t i, std::optional<double> least, Search& search);

}  // namespace fjr
