// The wave crests of a free decay and what (10)-(14) make of them.
#pragma once

#include <cstddef>
#include <vector>

#include "model/identify/fit.h"

namespace fjr {

struct Curve {
  std::vector<double> time, q;  // [s], [rad]
};

struct Crest {
  std::size_t row;
  double time, height;  // above the mean position
};

// The highest point of every range above a quarter of the last crest.
std::vector<Crest> crests(const Curve& curve);

// The line (12) through the logarithms of the crests; its slope is all damping, hysteresis included.
Fit decrement_line(const std::vector<Crest>& all);

// (12) and (14) from the crests: slope of their logarithm and time between them.
struct Decrement {
  double k, d;  // [1/s^2], [1/s]
};
Decrement decrement(const std::vector<Crest>& all);

}  // namespace fjr
