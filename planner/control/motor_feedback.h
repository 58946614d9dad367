// The executor's control law.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "model/encoder.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kTick = 1e-3;  // [s] of the executor

inline constexpr int kDitherAfter = 5;    // [ticks] a motor that only reverses is not disturbed
inline constexpr int kDitherPeriod = 10;  // [ticks] 100 Hz: nine times the arm's highest natural frequency
// [-] of the swing, in half widths of the band in which the law falls (FrictionLaw::unstable_band): in the mean over a
// swing the slope of joint 2's law is -5.3, 0, 12, 19, 29, 37 N m s/rad at 0, 1.44, 3, 4, 6, 20 of them.
inline constexpr double kDitherBands = 4;

// A torque that keeps a motor moving where it is to rest, for a friction law that falls with speed at rest (joint 2's).
// At rest such a motor runs away, and no feedback through encoders is quick enough to see it. While it swings with a
// few times the speeds at which the law falls, its friction rises with speed in the mean, and errors of its velocity
// decay. The swing itself moves a motor over a fifteenth of a count of its link's encoder. It is added to the planned
// velocity, which may creep: the torque makes up for the difference between the friction of the two together and that
// of the plan, which is in the planned torque.
class Dither {
 public:
  Dither(const Parameters& p, std::size_t joint, double tick);

  // [N m] on top of the planned torque for the next tick, given the planned velocity [rad/s]. 0 unless the plan has
  // rested, or crept within the band, for kDitherAfter ticks.
  double next(double planned_velocity);

  // [rad/s] of the swing; 0: the law does not fall.
  double amplitude() const { return amplitude_; }

  // The tick of the swing that next() gave last, from 1 on; 0: none.
  std::size_t swing_tick() const { return rested_ > kDitherAfter ? rested_ - kDitherAfter : 0; }

 private:
  static constexpr int kParts = 8;  // of a tick, over which the friction of the swing is averaged

  FrictionLaw law_;
  double band_, amplitude_;                                             // [rad/s]
  std::array<std::array<double, kParts>, kDitherPeriod> velocities_{};  // [rad/s] of the swing, tick by tick
  std::array<double, kDitherPeriod> accelerating_{};                    // [N m] the motor by the swing, tick by tick
  std::size_t rested_ = 0;                                              // ticks
};

// What Dither gives along a trajectory, tick by tick from its first row on: it depends on the plan alone.
class PlannedDither {
 public:
  PlannedDither(const Parameters& p, const Trajectory& trajectory, double tick = kTick);

  // [N m] in the tick that `time` is in.
  Joints<double> at(double time) const;
  // Where it steps, increasing. [s]
  const std::vector<double>& steps() const { return steps_; }

 private:
  struct Swing {
    std::size_t first;            // tick
    std::vector<double> torques;  // [N m] tick by tick
  };

  double start_, tick_;
  Joints<std::vector<Swing>> swings_;
  std::vector<double> steps_;
};

// Feedback from the encoders on top of a feed-forward torque, once a tick.
// - Motors: within one count of its encoder nothing is known of a motor, so there is no error while the plan is in the
//   count that is read. Beyond, position and velocity gains act on the error; velocities come from differences through
//   a low-pass. (Every count taken for an error would kick the arm off by 7 counts of the link encoder on a motion.)
// - Links: within the count of a motor the finer encoder of its link tells. Across a spring feedback is stable with
//   less than the spring's stiffness; it has half, for errors up to half a count of the motor. Where the plan rests,
//   and the link is where it should be, it is also believed more than a motor's encoder that is a count off.
// - Where a motor rests whose friction falls with speed: Dither.
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

  // What is taken for the error of motor j where its encoder differs from the plan by `difference`. [rad]
  static double motor_error(const Parameters& p, std::size_t j, double difference);
  // What is taken for the error of link j at `measured`, before quantisation. [rad]
  static double link_error(const Parameters& p, std::size_t j, double planned, double measured);
  // Of the error of a link. [N m/rad]
  static double link_gain(const Parameters& p, std::size_t j);

  // Position errors now are no velocities. Measured: before quantisation.
  void start(const Joints<double>& planned_theta, const Joints<double>& measured_theta);

  // The planned motor positions given from now on differ by so much from those before, which is no motion. [rad]
  void shift_plan(const Joints<double>& by);

  // Positions at the beginning of the tick, measured ones before quantisation; planned motor velocities [rad/s];
  // feed-forward torque for the tick [N m]. Joints that are `blind` get none of the feedback.
  Command command(const Positions& planned, const Joints<double>& planned_velocity, const Positions& measured,
                  const Joints<double>& feedforward, const Joints<bool>& blind = {});

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

  // Command for [time, time + tick], given the positions at `time` before quantisation. Call once a tick, in order.
  // Beyond the end: the last row is held.
  Command command(double time, const MotorFeedback::Positions& measured);

 private:
  Interpolator plan_;
  double tick_;
  MotorFeedback feedback_;
};

// How far from where it is to rest the arm may be before a motion: half a count of the link encoder, within which it
// is held. [rad]
inline double rest_error(const Parameters& p, std::size_t joint) {
  return count_angle(p.encoder.link_counts[joint]) / 2;
}

}  // namespace fjr
