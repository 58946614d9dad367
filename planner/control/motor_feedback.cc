#include "planner/control/motor_feedback.h"

#include <algorithm>
#include <cmath>

namespace fjr {

MotorFeedback::MotorFeedback(const Parameters& p, double tick)
    : p_(p),
      measured_{VelocityFilter(p.feedback.velocity_filter[0], tick),
                VelocityFilter(p.feedback.velocity_filter[1], tick)},
      planned_(measured_) {}

void MotorFeedback::start(const Pair<double>& planned, const Pair<double>& measured, const Pair<double>& velocity) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    measured_[j].reset(quantised(measured[j], p_.encoder.motor_counts[j]), velocity[j]);
    planned_[j].reset(planned[j], velocity[j]);
  }
}

void MotorFeedback::shift_plan(const Pair<double>& by) {
  for (std::size_t j = 0; j < kJoints; ++j) planned_[j].shift(by[j]);
}

MotorFeedback::Command MotorFeedback::command(const Pair<double>& planned, const Pair<double>& measured,
                                              const Pair<double>& feedforward, const Pair<bool>& blind) {
  Command c{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double counted = quantised(measured[j], p_.encoder.motor_counts[j]);
    const double velocity_error = planned_[j].update(planned[j]) - measured_[j].update(counted);
    if (!blind[j]) {
      c.feedback[j] =
          p_.feedback.position_gain[j] * (planned[j] - counted) + p_.feedback.velocity_gain[j] * velocity_error;
    }
    const double wanted = feedforward[j] + c.feedback[j], peak = p_.drive.peak_torque[j];
    c.torque[j] = std::clamp(wanted, -peak, peak);
    c.saturated |= std::abs(wanted) > peak;
  }
  return c;
}

TickController::TickController(const Parameters& p, const Trajectory& trajectory, double tick)
    : plan_(trajectory), tick_(tick), feedback_(p, tick) {
  const State<double>& start = trajectory.samples.front().state;
  feedback_.start(start.theta, start.theta, start.dtheta);
}

TickController::Command TickController::command(double time, const Pair<double>& theta) {
  return feedback_.command(plan_.at(time).state.theta, theta, plan_.mean_torque(time, time + tick_));
}

}  // namespace fjr
