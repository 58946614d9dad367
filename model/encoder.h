// Encoders of the platform: positions in whole counts; velocities only by filtered numerical differentiation.
#pragma once

#include <cmath>
#include <numbers>

namespace fjr {

// Angle of one count. [rad]
inline double count_angle(double counts_per_revolution) { return 2 * std::numbers::pi / counts_per_revolution; }

// What an encoder with that many counts per revolution reports for `angle` [rad].
inline double quantised(double angle, double counts_per_revolution) {
  const double count = count_angle(counts_per_revolution);
  return std::round(angle / count) * count;
}

// Velocity from sampled positions: backward difference, then a first-order low-pass discretised exactly for its period.
// Raw differences are useless here: one count per 1 ms tick is 1.57 rad/s on motor 1.
class VelocityFilter {
 public:
  // cutoff [Hz], period [s]
  VelocityFilter(double cutoff, double period)
      : keep_(std::exp(-2 * std::numbers::pi * cutoff * period)), period_(period) {}

  void reset(double position, double velocity) {
    last_ = position;
    velocity_ = velocity;
  }

  // What counts as position moves by `by` [rad], which is no velocity.
  void shift(double by) { last_ += by; }

  // position [rad] of this tick -> filtered velocity [rad/s]
  double update(double position) {
    const double difference = (position - last_) / period_;
    last_ = position;
    velocity_ = keep_ * velocity_ + (1 - keep_) * difference;
    return velocity_;
  }

 private:
  double keep_, period_, last_ = 0, velocity_ = 0;
};

}  // namespace fjr
