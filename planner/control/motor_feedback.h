// The executor's control law.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "model/encoder.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kTick = 1e-3;  // [s] of the executor

inline constexpr int kDitherAfter = 5;    // [ticks] at rest before dither begins, so that a reversal is not disturbed
inline constexpr int kDitherPeriod = 10;  // [ticks] 100 Hz: nine times the arm's highest natural frequency
// [-] velocity amplitude of the dither, in half widths of the band in which friction falls with speed
// (FrictionLaw::unstable_band). With amplitudes of 0, 1.44, 3, 4, 6, 20 half widths, the slope of joint 2's law,
// averaged over a period, is -5.3, 0, 12, 19, 29, 37 N m s/rad.
inline constexpr double kDitherBands = 4;

// A dither torque that keeps a motor oscillating while it should rest, for a friction law that falls with speed near
// rest (joint 2's). Such a motor is unstable at rest, and feedback through encoders detects that too late. While it
// oscillates several times faster than the speeds at which the law falls, its friction rises with speed on average, and
// velocity errors decay. The oscillation moves the motor by a fifteenth of a count of its link's encoder. It is added
// to the planned velocity, which may be a slow creep: the dither torque is the friction at the sum of both velocities,
// less the friction of the plan (which the planned torque contains), plus the torque that accelerates the motor.
class Dither {
 public:
  Dither(const Parameters& p, std::size_t joint, double tick);

  // Returns the torque [N m] to add to the planned one for the next tick, given the planned velocity [rad/s]. It is 0
  // unless the planned velocity has stayed within the unstable band for kDitherAfter ticks.
  double next(double planned_velocity);

  // Returns the velocity amplitude [rad/s]; 0 if the friction law does not fall.
  double amplitude() const { return amplitude_; }

  // Returns the number, from 1, of the dither tick that next() returned last; 0 if it did not dither.
  std::size_t swing_tick() const { return rested_ > kDitherAfter ? rested_ - kDitherAfter : 0; }

 private:
  static constexpr int kParts = 8;  // parts of a tick over which the friction is averaged

  FrictionLaw law_;
  double band_, amplitude_;                                             // [rad/s]
  std::array<std::array<double, kParts>, kDitherPeriod> velocities_{};  // [rad/s] oscillation, per tick and part
  std::array<double, kDitherPeriod> accelerating_{};                    // [N m] inertia torque of it, per tick
  std::size_t rested_ = 0;                                              // [ticks] within the unstable band so far
};

// The torques of Dither along a trajectory, computed in advance for every tick. That is possible because they depend
// only on the planned velocities.
class PlannedDither {
 public:
  PlannedDither(const Parameters& p, const Trajectory& trajectory, double tick = kTick);

  // Returns the dither torque [N m] in the tick that contains `time`.
  Joints<double> at(double time) const;
  // Returns the times [s] at which it changes, in increasing order.
  const std::vector<double>& steps() const { return steps_; }

 private:
  struct Swing {
    std::size_t first;            // tick
    std::vector<double> torques;  // [N m] per tick
  };

  double start_, tick_;
  Joints<std::vector<Swing>> swings_;
  std::vector<double> steps_;
};

// Feedback from the encoders on top of a feed-forward torque, once a tick.
// - Motors: the position of a motor is known only to one count of its encoder, so the error is 0 while the plan lies in
//   the count that is read. Otherwise position and velocity gains act on the error; the velocity error comes from
//   differences through a low-pass filter. (Without this dead band, every count would act as an error and push the
//   links off the plan by 7 counts of the link encoder during a motion.)
// - Links: within a count of the motor encoder, the finer encoder of the link is used. This feedback acts across the
//   spring and is stable with a gain below the spring's stiffness; its gain is half of that, for errors up to half a
//   count of the motor. If the plan rests and the link is in place, a motor encoder that is a count off is ignored.
// - Motors at rest whose friction falls with speed get the torque of Dither.
// Feed-forward friction is part of the planned torque: it follows the planned velocity.
class MotorFeedback {
 public:
  struct Command {
    Joints<double> torque;    // [N m] to the drive, within its peak torque
    Joints<double> feedback;  // [N m] the part of it that is feedback, before clamping
    bool saturated;
  };
  struct Positions {
    Joints<double> theta, q;  // [rad]
  };

  MotorFeedback(const Parameters& p, double tick);

  // Returns the position error [rad] of motor j that the feedback uses, if its encoder differs from the plan by
  // `difference` [rad].
  static double motor_error(const Parameters& p, std::size_t j, double difference);
  // Returns the position error [rad] of link j that the feedback uses. planned, measured: [rad], before quantisation.
  static double link_error(const Parameters& p, std::size_t j, double planned, double measured);
  // Returns the gain of the link error [N m/rad].
  static double link_gain(const Parameters& p, std::size_t j);

  // Initialises the velocity filters with the present position errors [rad], so that these do not look like velocities.
  // measured_theta: before quantisation.
  void start(const Joints<double>& planned_theta, const Joints<double>& measured_theta);

  // Announces that the planned motor positions jump by `by` [rad] from now on, so that the velocity filters do not take
  // the jump for a motion.
  void shift_plan(const Joints<double>& by);

  // Computes the command for one tick from the planned and measured positions at its beginning (measured before
  // quantisation), the planned motor velocities [rad/s] and the feed-forward torque for the tick [N m]. Joints marked
  // in `blind` get no feedback. ticks: since the last command, more than 1 if ticks were missed.
  Command command(const Positions& planned, const Joints<double>& planned_velocity, const Positions& measured,
                  const Joints<double>& feedforward, const Joints<bool>& blind = {}, int ticks = 1);

 private:
  double motor_error(std::size_t j) const { return motor_error(p_, j, difference_[j]); }
  bool link_says_it_rests(std::size_t j, double link_error, const Joints<double>& planned_velocity) const;

  Parameters p_;
  Joints<double> difference_{};  // [rad] planned - measured of the motors, at the last tick
  Joints<VelocityFilter> error_velocity_;
  Joints<Dither> dither_;
};

// MotorFeedback along a trajectory: each tick commands the mean of the planned torque over the coming tick.
class TickController {
 public:
  using Command = MotorFeedback::Command;

  // The trajectory must outlive the controller; tick [s].
  TickController(const Parameters& p, const Trajectory& trajectory, double tick = kTick);

  // Returns the command for [time, time + tick], given the positions at `time` before quantisation. It must be called
  // once per tick, in order. Beyond the end of the trajectory the last sample is held.
  Command command(double time, const MotorFeedback::Positions& measured);

 private:
  Interpolator plan_;
  double tick_;
  MotorFeedback feedback_;
};

// Returns how far [rad] a joint may be from its rest position before a motion: half a count of the link encoder, within
// which the executor holds it.
inline double rest_error(const Parameters& p, std::size_t joint) {
  return count_angle(p.encoder.link_counts[joint]) / 2;
}

}  // namespace fjr
