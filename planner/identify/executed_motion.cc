#include "planner/identify/executed_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

constexpr double kLongestGap = 6.5e-3;    // [s] allows five missed ticks; after more, the drives brake
constexpr std::size_t kFewestTicks = 50;  // shorter motions contain too little information
constexpr double kLongestMotion = 120;    // [s]

Joints<const std::vector<double>*> columns(const Log& log, std::string_view quantity, std::string_view suffix = "") {
  return {&log.column(joint_column(quantity, 0, suffix)), &log.column(joint_column(quantity, 1, suffix))};
}

std::vector<Joints<double>> pairs(const Joints<const std::vector<double>*>& both, std::size_t rows) {
  std::vector<Joints<double>> all(rows);
  for (std::size_t i = 0; i < rows; ++i) all[i] = {(*both[0])[i], (*both[1])[i]};
  return all;
}

// Returns the number of rows up to and including the first one from which on the plan rests.
std::size_t moving_rows(const Log& log) {
  const auto q = columns(log, "q", "_plan"), theta = columns(log, "theta", "_plan");
  std::size_t rows = log.rows();
  const auto rests = [&](std::size_t i) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if ((*q[j])[i] != q[j]->back() || (*theta[j])[i] != theta[j]->back()) return false;
    }
    return true;
  };
  while (rows > 1 && rests(rows - 2)) --rows;
  return rows;
}

// Checks that the drives did not brake during the motion. Up to five missed ticks in a row are visible as gaps in time.
// After more, the executor continued without a gap, so that the number of missed ticks exceeds the visible ones.
void check_ticks(const Log& log, const std::vector<double>& times) {
  double visible = 0;
  for (std::size_t i = 1; i < log.rows(); ++i) {
    const double step = log.column("time")[i] - log.column("time")[i - 1];
    visible += std::round(step / kTick) - 1;
    if (i >= times.size() || step <= kLongestGap) continue;
    throw InputError(log.source, fmt::format("time, row {}", i + 1),
                     fmt::format("{:g} s after the row before; the executor's are {:g} s apart, and after more than "
                                 "{:g} s the drives brake, with torques that are not in the log",
                                 step, kTick, kLongestGap));
  }
  const double missed = log.number("missed_ticks", 0);
  if (missed > visible + 0.5) {
    throw InputError(
        log.source, "# missed_ticks",
        fmt::format("{:g}, of which {:g} are to be seen in the times: the drives have braked, with torques "
                    "that are not in the log",
                    missed, visible));
  }
}

}  // namespace

ExecutedMotion executed_motion(const Log& log) {
  const std::size_t rows = moving_rows(log);
  ExecutedMotion motion;
  motion.log = log.source;
  motion.hash = log.hash;
  const std::vector<double>& times = log.column("time");
  motion.times.assign(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(rows));
  check_ticks(log, motion.times);
  const double duration = motion.times.back() - motion.times.front();
  if (rows < kFewestTicks || duration > kLongestMotion) {
    throw InputError(log.source, "time",
                     fmt::format("the plan moves for {} rows and {:g} s, from {} rows to {:g} s are needed", rows,
                                 duration, kFewestTicks, kLongestMotion));
  }
  motion.q = pairs(columns(log, "q"), rows);
  motion.theta = pairs(columns(log, "theta"), rows);
  motion.torque = pairs(columns(log, "tau"), rows);
  motion.planned_theta = pairs(columns(log, "theta", "_plan"), rows);
  const std::vector<Joints<double>> planned = pairs(columns(log, "q", "_plan"), rows);
  for (std::size_t j = 0; j < kJoints; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < rows; ++i) sum += std::pow(motion.q[i][j] - planned[i][j], 2);
    motion.link_error_rms[j] = std::sqrt(sum / static_cast<double>(rows));
  }
  return motion;
}

}  // namespace fjr
