// Random requests that can be had for certain: each is asked of a smooth random motion that keeps every limit and
// constraint of it, by construction. Whoever calls one of them infeasible is wrong.
#pragma once

#include <cstdint>
#include <string>

#include "model/parameters.h"

namespace fjr {

struct RandomRequest {
  std::string kind;  // "rest, via, obstacles": what it is made of, for counting
  std::string yaml;
  double duration = 0;  // [s] of the motion that it was made from
};

// The same for the same robot and seed, on every machine. Rest and motion at both ends, all objectives but throws,
// durations fixed, free and bounded, via points, obstacles, regions of the tip, paths, goals as sets, tightened limits,
// payloads, sample periods.
RandomRequest random_request(const Parameters& robot, std::uint64_t seed);

}  // namespace fjr
