#include "planner/executor/figures.h"

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

void raise(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

// The limits of the request are not known to the executor.
constexpr bool is_reported(const QuantityInfo& quantity) { return quantity.of_robot != nullptr; }

}  // namespace

void Figures::add(const Parameters& robot, const Instant& now) {
  moving_ += now.moving ? 1 : 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double error = now.measured.q[j] - now.planned_q[j];
    if (now.moving) {
      raise(largest_[j], error);
      squares_[j] += error * error;
    } else {
      raise(residual_[j], error);
    }
    last_[j] = std::abs(error);
    raise(feedback_[j], now.feedback[j]);
  }
  constexpr Joints<double> kNoRate{};
  raise(reached_, Moment<double>{robot, now.measured, now.torque, kNoRate}, is_reported);
}

void Figures::fill(ExecutionResult& result, const Parameters& robot) const {
  result.link_error = largest_;
  result.final_link_error = last_;
  result.residual_vibration = residual_;
  result.feedback_torque = feedback_;
  const Limits of_robot = Limits::of(robot);
  for (std::size_t j = 0; j < kJoints; ++j) {
    result.link_error_rms[j] = std::sqrt(squares_[j] / static_cast<double>(std::max(1L, moving_)));
    for (const QuantityInfo& quantity : Quantities::infos) {
      if (!is_reported(quantity)) continue;
      result.limits.push_back({quantity.name_with_feedback ? quantity.name_with_feedback : quantity.name,
                               static_cast<int>(j) + 1, quantity.with_feedback_in(robot, of_robot, j),
                               quantity.in(reached_, j)});
    }
  }
}

}  // namespace fjr
