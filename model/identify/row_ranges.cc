#include "model/identify/row_ranges.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "model/identify/fit.h"

namespace fjr {
namespace {

constexpr std::size_t kRangeBlocks = 4;  // number of blocks in the shortest range
constexpr double kChanged = 5;           // standard deviations between the means of blocks that count as a change
constexpr double kStill = 1e-6;          // fraction of its range by which a signal without noise may change

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// Returns the difference between the means of two blocks beyond which the signal has changed.
double allowed_change(const Signal& signal, std::size_t block) {
  const std::vector<double>& values = signal.values;
  std::vector<double> differences;
  for (std::size_t i = 1; i < values.size(); ++i) differences.push_back(std::abs(values[i] - values[i - 1]));
  const double sigma = kMadToSigma * median(std::move(differences)) / std::sqrt(2.0);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double by_noise = kChanged * sigma * std::sqrt(2.0 / static_cast<double>(block));
  return std::max({by_noise, signal.resolution, kStill * (*high - *low)});
}

}  // namespace

std::vector<RowRange> commanded_ranges(const std::vector<double>& planned) {
  std::vector<RowRange> ranges;
  for (std::size_t from = 0; from < planned.size();) {
    std::size_t to = from + 1;
    while (to < planned.size() && planned[to] == planned[from]) ++to;
    if (planned[from] != 0) ranges.push_back({from, to});
    from = to;
  }
  return ranges;
}

std::vector<RowRange> steady_ranges(const std::vector<Signal>& signals, std::size_t shortest) {
  const std::size_t block = std::max<std::size_t>(shortest / kRangeBlocks, 1), rows = signals.front().values.size();
  std::vector<double> allowed;
  for (const Signal& signal : signals) allowed.push_back(allowed_change(signal, block));
  const auto changed = [&](std::size_t a, std::size_t b) {
    for (std::size_t k = 0; k < signals.size(); ++k) {
      const std::span<const double> signal = signals[k].values;
      if (std::abs(mean(signal.subspan(a, block)) - mean(signal.subspan(b, block))) > allowed[k]) return true;
    }
    return false;
  };
  std::vector<RowRange> ranges;
  for (std::size_t from = 0; from + block <= rows;) {
    std::size_t to = from + block;
    while (to + block <= rows && !changed(from, to) && !changed(to - block, to)) to += block;
    if (to - from >= shortest) ranges.push_back({from, to});
    from = to;
  }
  return ranges;
}

}  // namespace fjr
