// Times of via points that cannot be kept.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/search.h"

namespace fjr {

// Returns the earliest time [s] at which via point i can be passed. The times of those before it are kept, and what
// comes after is ignored. Returns nothing if no motion there is found.
std::optional<double> earliest_at(const Problem& problem, std::size_t i, Search& search);

struct NearestTime {
  std::optional<double> time;     // [s] none: no other time of this via point helps
  std::optional<Guess> as_asked;  // a motion at the requested time after all, found from those at other times
};

// Finds the least change of the time of via point i alone that makes the rest of the request feasible. least: the
// earliest possible time, which is the result if it is enough.
NearestTime nearest_time(const Problem& problem, std::size_t i, std::optional<double> least, Search& search);

}  // namespace fjr
