// The executor's control law.
#pragma once

#include "model/encoder.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kTick = 1e-3;  // [s] of the executor

// Motor-side feedback from the motor encoders on top of a feed-forward torque, once a tick. Velocities come from
// differentiated counts through a low-pass; the planned positions go through the same differentiation and low-pass, so
// that its lag (5 ms at 30 Hz: 0.5 rad/s while a motor gains 100 rad/s^2) does not look like an error. Feed-forward
// friction is part of the planned torque: it follows the planned velocity.
class MotorFeedback {
 public:
  struct Command {
    Pair<double> torque;    // [N m] to the drive, within its peak torque
    Pair<double> feedback;  // [N m] the part of it that is feedback, before clamping
    bool saturated;
  };

  MotorFeedback(const Parameters& p, double tick);

  // Both filters begin at the planned velocity. [rad], [rad/s]
  void start(const Pair<double>& planned, const Pair<double>& measured, const Pair<double>& velocity);

  // The planned positions given from now on differ by so much from those before, which is no motion. [rad]
  void shift_plan(const Pair<double>& by);

  // Motor positions at the beginning of the tick, measured ones before quantisation [rad]; feed-forward torque for the
  // tick [N m]. Joints that are `blind` get none of the feedback.
  Command command(const Pair<double>& planned, const Pair<double>& measured, const Pair<double>& feedforward,
                  const Pair<bool>& blind = {});

 private:
  Parameters p_;
  Pair<VelocityFilter> measured_, planned_;
};

// MotorFeedback along a trajectory: each tick commands the mean of the planned torque over the coming tick.
class TickController {
 public:
  using Command = MotorFeedback::Command;

  // The trajectory must outlive the controller; tick [s].
  TickController(const Parameters& p, const Trajectory& trajectory, double tick = kTick);

  // Command for [time, time + tick], given the motor positions at `time` [rad] before quantisation. Call once a tick,
  // in order. Beyond the end: the last row is held.
  Command command(double time, const Pair<double>& theta);

 private:
  Interpolator plan_;
  double tick_;
  MotorFeedback feedback_;
};

// How far from where it is to rest the arm may be before a motion: some counts of the link encoder, between which it
// wanders when it is held, because motor 2 is unstable at rest (2.1e-4 rad at most were measured). [rad]
inline constexpr double kRestError = 2.5e-4;

}  // namespace fjr
