#include "planner/executor/virtual_arm.h"

#include <cmath>
#include <stdexcept>

#include "model/encoder.h"
#include "planner/certificate/tracking.h"

namespace fjr {
namespace {

constexpr int kPieces = 4;  // of a tick, in which the hysteresis stands still

// z after the deflection has changed by `change` [rad]: dz/dphi = (1 - z sign(dphi)) / width, solved exactly.
double hysteresis_after(double z, double change, double width) {
  const double towards = change > 0 ? 1 : -1;
  return towards + (z - towards) * std::exp(-std::abs(change) / width);
}

}  // namespace

VirtualArm::VirtualArm(const VirtualArmOptions& options, const Pair<double>& q)
    : options_(options),
      rollout_(with_payload(options.truth, {options.payload}), Limits{}, Accuracy::of_predictions()),
      state_(rest_at(with_payload(options.truth, {options.payload}), q)) {}

Reading VirtualArm::read() {
  const Parameters& p = options_.truth;
  Reading reading;
  for (std::size_t j = 0; j < kJoints; ++j) {
    reading.theta[j] = quantised(state_.theta[j], p.encoder.motor_counts[j]);
    reading.q[j] = quantised(state_.q[j], p.encoder.link_counts[j]);
  }
  if (!options_.fault) return reading;
  const auto which = static_cast<std::size_t>(options_.fault->encoder), j = which % kJoints;
  const bool of_motor = which >= kJoints;
  faulty_ = faulty_ || std::abs(of_motor ? state_.dtheta[j] : state_.dq[j]) > options_.fault->above;
  if (faulty_) (of_motor ? reading.theta : reading.q)[j].reset();
  return reading;
}

void VirtualArm::command(const Pair<double>& torque) {
  if (options_.hysteresis.height == Pair<double>{}) return advance(torque, kTick);
  for (int i = 0; i < kPieces; ++i) advance(torque, kTick / kPieces);
}

// A hysteresis torque that stands still is a spring whose rest is elsewhere: tau_c = K (theta + h z / K - q).
void VirtualArm::advance(const Pair<double>& torque, double duration) {
  const Hysteresis& h = options_.hysteresis;
  Pair<double> before;
  State<double> x = state_;
  for (std::size_t j = 0; j < kJoints; ++j) {
    before[j] = x.theta[j] - x.q[j];
    x.theta[j] += h.height[j] * z_[j] / options_.truth.spring.stiffness[j];
  }
  rollout_.start(0, x, Drive::holding({0, {}, torque}));
  if (!rollout_.run(duration, {}, {}, {})) throw std::runtime_error("the simulated arm: " + rollout_.failure());
  state_ = rollout_.state();
  for (std::size_t j = 0; j < kJoints; ++j) {
    state_.theta[j] -= h.height[j] * z_[j] / options_.truth.spring.stiffness[j];
    z_[j] = hysteresis_after(z_[j], state_.theta[j] - state_.q[j] - before[j], h.width[j]);
  }
}

}  // namespace fjr
