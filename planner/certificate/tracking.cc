#include "planner/certificate/tracking.h"

#include <algorithm>
#include <cmath>

#include "planner/certificate/rollout.h"

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

namespace {

void keep_largest(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

// Errors are what the link encoders see of them.
Tracking run_ticks(const Parameters& p, const Trajectory& trajectory) {
  Tracking t;
  State<double> x = trajectory.samples.front().state;
  TickController controller(p, trajectory);
  Interpolator plan(trajectory);
  Rollout arm(p, Limits{}, Accuracy::of_predictions());
  const double start = trajectory.start_time(), end = trajectory.end_time();
  const auto ticks = static_cast<long>(std::ceil((end - start) / kTick - 1e-9));
  for (long k = 0; k < ticks; ++k) {
    const double now = start + static_cast<double>(k) * kTick, next = std::min(end, now + kTick);
    const TickController::Command command = controller.command(now, x.theta);
    if (k == 0) arm.start(now, x, Drive::holding({now, {}, command.torque}));
    arm.hold(command.torque);
    if (!arm.run(next, {}, {}, {})) break;
    x = arm.state();
    const State<double> wanted = plan.at(next).state;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = quantised(x.q[j], p.encoder.link_counts[j]) - wanted.q[j];
      keep_largest(t.link_error[j], error);
      t.link_error_rms[j] += error * error / static_cast<double>(ticks);
      keep_largest(t.feedback_torque[j], command.feedback[j]);
      keep_largest(t.peak_torque[j], command.torque[j]);
    }
    t.saturated |= command.saturated;
  }
  for (double& rms : t.link_error_rms) rms = std::sqrt(rms);
  return t;
}

}  // namespace

Tracking predict_tracking(const Parameters& p, const Trajectory& trajectory) {
  Tracking t = run_ticks(p, trajectory);
  for (std::size_t j = 0; j < kJoints; ++j) t.link_error[j] += kRestCounts * count_angle(p.encoder.link_counts[j]);
  return t;
}

}  // namespace fjr
