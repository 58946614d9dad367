// Ranges of rows of a log over which the motor did one thing.
#pragma once

#include <cstddef>
#include <vector>

namespace fjr {

struct RowRange {
  std::size_t from, to;  // rows [from, to)

  std::size_t rows() const { return to - from; }
};

// Where a commanded value stays the same and is not zero.
std::vector<RowRange> commanded_ranges(const std::vector<double>& planned);

struct Signal {
  std::vector<double> values;
  double resolution;  // changes below this say nothing
};

// Without a command: where none of the measured signals (equally long) changes by more than its own noise, which is
// known from the differences of neighbours, or its resolution, for at least `shortest` rows.
std::vector<RowRange> steady_ranges(const std::vector<Signal>& signals, std::size_t shortest);

}  // namespace fjr
