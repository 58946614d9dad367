#include "planner/certificate/tracking.h"

#include <algorithm>
#include <cmath>

#include "model/encoder.h"
#include "planner/certificate/simulation.h"
#include "planner/certificate/ticks.h"

namespace fjr {
namespace {

void keep_largest(double& largest, double value) { largest = std::max(largest, std::abs(value)); }

// Runs the executor's ticks. Errors are measured by the link encoders.
Tracking run_ticks(const Parameters& p, const Trajectory& trajectory) {
  Tracking t;
  Interpolator plan(trajectory);
  double ticks = 0;
  roll_out_ticks(p, p, trajectory, trajectory.samples.front().state, [&](const SimulatedTick& tick) {
    const State<double> wanted = plan.at(tick.end).state;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double error = quantised(tick.state.q[j], p.encoder.link_counts[j]) - wanted.q[j];
      keep_largest(t.link_error[j], error);
      t.link_error_rms[j] += error * error;
      keep_largest(t.feedback_torque[j], tick.command.feedback[j]);
      keep_largest(t.peak_torque[j], tick.command.torque[j]);
    }
    t.saturated |= tick.command.saturated;
    ++ticks;
  });
  for (double& rms : t.link_error_rms) rms = std::sqrt(rms / std::max(1.0, ticks));
  return t;
}

}  // namespace

Tracking predict_tracking(const Parameters& p, const Trajectory& trajectory) {
  Tracking t = run_ticks(p, trajectory);
  for (std::size_t j = 0; j < kJoints; ++j) t.link_error[j] += kRestCounts * count_angle(p.encoder.link_counts[j]);
  return t;
}

}  // namespace fjr
