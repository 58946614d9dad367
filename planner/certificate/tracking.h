// The executor's control law, and what it can be expected to do on the hardware.
#pragma once

#include "model/encoder.h"
#include "planner/certificate/certificate.h"

namespace fjr {

inline constexpr double kTick = 1e-3;  // [s] of the executor

// One command per tick: the mean of the planned torque over the coming tick, plus motor-side feedback from the motor
// encoders. Velocities come from differentiated counts through a low-pass; the planned positions go through the same
// differentiation and low-pass, so that its lag (5 ms at 30 Hz: 0.5 rad/s while a motor gains 100 rad/s^2) does not
// look like an error. Feed-forward friction is part of the planned torque: it follows the planned velocity.
class TickController {
 public:
  struct Command {
    Pair<double> torque;    // [N m] to the drive, within its peak torque
    Pair<double> feedback;  // [N m] the part of it that is feedback, before clamping
    bool saturated;
  };

  // The trajectory must outlive the controller; tick [s].
  TickController(const Parameters& p, const Trajectory& trajectory, double tick = kTick);

  // Command for [time, time + tick], given the motor positions at `time` [rad] before quantisation. Call once a tick,
  // in order. Beyond the end: the last row is held.
  Command command(double time, const Pair<double>& theta);

 private:
  Parameters p_;
  Interpolator plan_;
  double tick_;
  Pair<VelocityFilter> measured_, planned_;
};

// Runs the trajectory on the simulated arm under the TickController, torque held over every tick.
Tracking predict_tracking(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
