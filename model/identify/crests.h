// Finds the wave crests of a free decay, and evaluates them by (10)-(14).
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

// Returns the highest point of every range of samples above a quarter of the previous crest.
std::vector<Crest> crests(const Curve& curve);

// Fits the line (12) through the logarithms of the crests. Its slope contains all damping, including hysteresis.
Fit decrement_line(const std::vector<Crest>& all);

// The result of (12) and (14): from the slope of the logarithm of the crests and the time between them.
struct Decrement {
  double k, d;  // [1/s^2], [1/s]
};
Decrement decrement(const std::vector<Crest>& all);

}  // namespace fjr
