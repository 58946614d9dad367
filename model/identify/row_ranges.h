// Finds ranges of rows in a log in which a motor was in one steady condition.
#pragma once

#include <cstddef>
#include <vector>

namespace fjr {

struct RowRange {
  std::size_t from, to;  // rows [from, to)

  std::size_t rows() const { return to - from; }
};

// Returns the ranges in which a commanded value is constant and not zero.
std::vector<RowRange> commanded_ranges(const std::vector<double>& planned);

struct Signal {
  std::vector<double> values;
  double resolution;  // smaller changes are ignored
};

// For logs without commands: returns the ranges of at least `shortest` rows in which no measured signal (all equally
// long) changes by more than its noise, which is estimated from differences of neighbours, or its resolution.
std::vector<RowRange> steady_ranges(const std::vector<Signal>& signals, std::size_t shortest);

}  // namespace fjr
