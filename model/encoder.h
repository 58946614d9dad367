// Encoders of the platform. They give positions in whole counts; velocities come from filtered numerical
// differentiation.
#pragma once

#include <cmath>
#include <numbers>

namespace fjr {

// Returns the angle of one count [rad].
inline double count_angle(double counts_per_revolution) { return 2 * std::numbers::pi / counts_per_revolution; }

// Returns the reading [rad] of an encoder with that many counts per revolution at `angle` [rad].
inline double quantised(double angle, double counts_per_revolution) {
  const double count = count_angle(counts_per_revolution);
  return std::round(angle / count) * count;
}

// Estimates the velocity from sampled positions: a backward difference, followed by a first-order low-pass filter that
// is discretised exactly for its period. Unfiltered differences are useless, since one count per 1 ms tick is 1.57
// rad/s on motor 1.
class VelocityFilter {
 public:
  // cutoff [Hz], period [s]
  VelocityFilter(double cutoff, double period)
      : keep_(std::exp(-2 * std::numbers::pi * cutoff * period)), period_(period) {}

  void reset(double position, double velocity) {
    last_ = position;
    velocity_ = velocity;
  }

  // Shifts the position by `by` [rad] without affecting the velocity.
  void shift(double by) { last_ += by; }

  // Takes the position [rad] that was measured `periods` after the one before, and returns the filtered velocity
  // [rad/s].
  double update(double position, int periods = 1) {
    const double difference = (position - last_) / (periods * period_);
    const double keep = periods == 1 ? keep_ : std::pow(keep_, periods);
    last_ = position;
    velocity_ = keep * velocity_ + (1 - keep) * difference;
    return velocity_;
  }

 private:
  double keep_, period_, last_ = 0, velocity_ = 0;
};

}  // namespace fjr
