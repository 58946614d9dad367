#include "planner/executor/figures.h"

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

void raise(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

}  // namespace

void Figures::add(const Instant& now) {
  moving_ += now.moving ? 1 : 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double error = now.q[j] - now.planned_q[j];
    if (now.moving) {
      raise(largest_[j], error);
      squares_[j] += error * error;
    } else {
      raise(residual_[j], error);
    }
    last_[j] = std::abs(error);
    raise(feedback_[j], now.feedback[j]);
    raise(torque_[j], now.torque[j]);
    raise(motor_velocity_[j], now.dtheta[j]);
    lowest_[j] = std::min(lowest_[j], now.q[j]);
    highest_[j] = std::max(highest_[j], now.q[j]);
    raise(deflection_[j], now.theta[j] - now.q[j]);
  }
}

void Figures::fill(ExecutionResult& result, const Parameters& robot) const {
  result.link_error = largest_;
  result.final_link_error = last_;
  result.residual_vibration = residual_;
  result.feedback_torque = feedback_;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const int joint = static_cast<int>(j) + 1;
    const double middle = robot.limits.link_middle[j];
    const double furthest = highest_[j] < lowest_[j] ? 0 : std::max(highest_[j] - middle, middle - lowest_[j]);
    result.link_error_rms[j] = std::sqrt(squares_[j] / static_cast<double>(std::max(1L, moving_)));
    result.limits.push_back({"peak_torque", joint, robot.drive.peak_torque[j], torque_[j]});
    result.limits.push_back({"motor_velocity", joint, robot.limits.motor_velocity[j], motor_velocity_[j]});
    result.limits.push_back({"link_position", joint, robot.limits.link_position[j], furthest});
    result.limits.push_back({"spring_deflection", joint, robot.limits.spring_deflection[j], deflection_[j]});
  }
}

}  // namespace fjr
