#include "model/identify/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/input_error.h"
#include "model/identify/fit.h"

namespace fjr {
namespace {

constexpr double kPeriod = 10, kAveraged = 0.2;  // [s]; of the period: the paper's
constexpr double kMoving = 0.25;                 // of the fastest change: faster than this is a move
constexpr double kRegular = 0.05;                // of the period: how far steps may be off
constexpr double kEarly = 0.01;                  // of the period: the first samples of a move may not show it
constexpr double kMostly = 0.8;                  // of the steps have to be regular
constexpr double kAnotherUnit = 10;              // times the stated period
constexpr std::size_t kFewest = 8;               // steps

// Removes single outliers.
std::vector<double> median_of_three(const std::vector<double>& values) {
  std::vector<double> smooth = values;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) smooth[i] = median({values[i - 1], values[i], values[i + 1]});
  return smooth;
}

// Returns the times of the rows before each change of `theta` that belongs to a move.
std::vector<double> changes(const std::vector<double>& time, const std::vector<double>& theta) {
  std::vector<double> sizes;
  for (std::size_t i = 1; i < theta.size(); ++i) sizes.push_back(std::abs(theta[i] - theta[i - 1]));
  if (sizes.size() < kFewest) return {};
  std::vector<double> sorted = sizes;  // each of the fewest steps has at least one change
  std::nth_element(sorted.begin(), sorted.end() - kFewest, sorted.end());
  const double fast = sorted[sorted.size() - kFewest];
  std::vector<double> times;
  for (std::size_t i = 0; i < sizes.size() && fast > 0; ++i) {
    if (sizes[i] > kMoving * fast) times.push_back(time[i]);
  }
  return times;
}

// Returns the first change of every move, that is, each change after a pause.
std::vector<double> starts(const std::vector<double>& changes) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < changes.size(); ++i) gaps.push_back(changes[i] - changes[i - 1]);
  if (gaps.empty()) return {};
  const double pause = 0.5 * *std::max_element(gaps.begin(), gaps.end());
  std::vector<double> times{changes.front()};
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i] > pause) times.push_back(changes[i + 1]);
  }
  return times;
}

struct Rhythm {
  double start, period;  // [s]
};

std::optional<Rhythm> rhythm(const std::vector<double>& starts) {
  if (starts.size() < kFewest) return std::nullopt;
  std::vector<double> periods;
  for (std::size_t i = 1; i < starts.size(); ++i) periods.push_back(starts[i] - starts[i - 1]);
  const double usual = median(periods);
  const auto regular = static_cast<double>(
      std::count_if(periods.begin(), periods.end(), [&](double p) { return std::abs(p - usual) < kRegular * usual; }));
  if (regular < kMostly * static_cast<double>(periods.size())) return std::nullopt;
  const double span = starts.back() - starts.front(), period = span / std::round(span / usual);
  double late = 0;  // delay with which counts and samples may show the first move, compared to the others
  for (const double start : starts) {
    const double since = start - starts.front();
    late = std::max(late, period * std::round(since / period) - since);
  }
  return Rhythm{starts.front() - std::min(late, kRegular * period), period};
}

std::optional<Rhythm> moves_of(const Log& log, int joint) {
  const std::string planned = joint_column("theta", joint, "_plan");
  const std::vector<double>& theta = log.column(log.has(planned) ? planned : joint_column("theta", joint));
  return rhythm(starts(changes(log.column("time"), median_of_three(theta))));
}

double positive(const Log& log, const std::string& key, double otherwise) {
  const double value = log.number(key, otherwise);
  if (!(value > 0)) throw InputError(log.source, "# " + key, fmt::format("{} s must be more than 0", value));
  return value;
}

}  // namespace

Schedule schedule_of(const Log& log, int joint, std::vector<std::string>& warnings) {
  const bool stated = log.metadata.contains("period");
  const std::optional<Rhythm> moves = moves_of(log, joint);
  Schedule schedule{log.column("time").front(), positive(log, "period", moves ? moves->period : kPeriod), 0};
  schedule.average = positive(log, "average", kAveraged * schedule.period);
  if (schedule.average > schedule.period) {
    throw InputError(log.source, "# average", fmt::format("{} s is longer than the period", schedule.average));
  }
  const double tolerance = kRegular * schedule.period;
  if (moves && std::max(moves->period / schedule.period, schedule.period / moves->period) > kAnotherUnit) {
    throw InputError(log.source, "# period",
                     fmt::format("is {} s, but the motor moves every {:.3g} s: is time in another unit?",
                                 schedule.period, moves->period));
  }
  if (!stated && !moves) {
    warnings.push_back(fmt::format("no `# period:` and no regular steps to be seen: {} s taken for each", kPeriod));
  } else if (moves && std::abs(moves->period - schedule.period) > tolerance) {
    warnings.push_back(
        fmt::format("`# period:` says {} s, the motor moves every {:.3g} s", schedule.period, moves->period));
  } else if (moves && std::abs(moves->start - schedule.start) > tolerance) {
    schedule.start = moves->start - kEarly * schedule.period;  // the log begins before the staircase does
  }
  return schedule;
}

}  // namespace fjr
