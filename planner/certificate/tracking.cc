#include "planner/certificate/tracking.h"

#include <algorithm>
#include <cmath>

#include "model/encoder.h"
#include "planner/certificate/rollout.h"

namespace fjr {
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
    const TickController::Command command = controller.command(now, {x.theta, x.q});
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
