#include "planner/certificate/robust/sensitivities.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/certificate/robust/propagation.h"
#include "planner/certificate/ticks.h"
#include "planner/control/motor_feedback.h"

namespace fjr {

EquivalentGain::EquivalentGain(const Parameters& p, std::size_t joint, Encoder encoder) {
  constexpr int kPhases = 128, kErrors = 48;
  constexpr double kWidest = 4;  // standard deviations
  const bool of_motor = encoder == Encoder::kMotor;
  const double counts = of_motor ? p.encoder.motor_counts[joint] : p.encoder.link_counts[joint];
  const double count = count_angle(counts);
  const auto seen = [&](double planned, double error) {
    const double measured = planned + error;
    return of_motor ? MotorFeedback::motor_error(p, joint, planned - quantised(measured, counts))
                    : MotorFeedback::link_error(p, joint, planned, measured);
  };
  least_ = count / 64;
  for (int entry = 0; entry < kEntries; ++entry) {
    const double deviation = least_ * std::exp2(0.5 * entry);
    double along = 0, squared = 0;
    for (int k = 0; k < kErrors; ++k) {
      const double size = kWidest * (2 * (k + 0.5) / kErrors - 1), error = size * deviation;
      const double weight = std::exp(-0.5 * size * size);
      squared += weight * error * error * kPhases;
      for (int phase = 0; phase < kPhases; ++phase) {
        along -= weight * error * seen((phase + 0.5) / kPhases * count, error);
      }
    }
    gains_.push_back(along / squared);
  }
}

double EquivalentGain::at(double deviation) const {
  const double place = 2 * std::log2(std::max(deviation, least_) / least_);
  const double last = static_cast<double>(kEntries - 1);
  if (!(place < last)) return gains_.back();
  const auto before = static_cast<std::size_t>(place);
  const double beyond = place - static_cast<double>(before);
  return (1 - beyond) * gains_[before] + beyond * gains_[before + 1];
}

double EquivalentGain::slope_at(double deviation) const {
  const double place = 2 * std::log2(std::max(deviation, least_) / least_);
  if (!(place > 0 && place < static_cast<double>(kEntries - 1))) return 0;
  const auto before = static_cast<std::size_t>(place);
  return (gains_[before + 1] - gains_[before]) * 2 / (std::numbers::ln2 * deviation);
}

Sensitivities sensitivities(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty) {
  Sensitivities s;
  Propagation propagation(robot, trajectory, uncertainty);
  const double begin = trajectory.start_time(), end = trajectory.end_time();
  const long ticks = tick_count(trajectory);
  for (long k = 0; k < ticks; ++k) {
    const double now = begin + static_cast<double>(k) * kTick, next = std::min(end, now + kTick);
    propagation.pass(now, next);
    s.times.push_back(next);
    s.state.push_back(propagation.state());
    s.torque.push_back(propagation.torque());
  }
  return s;
}

}  // namespace fjr
