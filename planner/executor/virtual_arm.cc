#include "planner/executor/virtual_arm.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/encoder.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

constexpr int kPieces = 4;        // parts of a tick, in each of which the hysteresis torque is constant
constexpr double kBraked = 0.01;  // [s] time constant of the motor speed when a drive brakes
constexpr int kStopped = 2000;    // [ticks] of braking after which nothing moves any more

// Returns the hysteresis state z after the deflection has changed by `change` [rad]. It is the exact solution of
// dz/dphi = (1 - z sign(dphi)) / width.
double hysteresis_after(double z, double change, double width) {
  const double towards = change > 0 ? 1 : -1;
  return towards + (z - towards) * std::exp(-std::abs(change) / width);
}

}  // namespace

VirtualArm::VirtualArm(const VirtualArmOptions& options, const Joints<double>& q)
    : options_(options),
      rollout_(with_payload(options.truth, {options.payload}), Limits{}, Accuracy::of_predictions()),
      state_(rest_at(with_payload(options.truth, {options.payload}), q)) {}

Reading VirtualArm::read(int ticks) {
  for (int passed = 0; torque_ && passed < std::min(ticks, kStopped); ++passed) {
    pass_tick(passed <= kStallTicks ? *torque_ : braking());
  }
  return measure();
}

Reading VirtualArm::measure() {
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

void VirtualArm::pass_tick(const Joints<double>& torque) {
  if (options_.hysteresis.height == Joints<double>{}) return advance(torque, kTick);
  for (int i = 0; i < kPieces; ++i) advance(torque, kTick / kPieces);
}

// Returns the torque of drives that get no commands: it holds the motors against the springs and brakes them.
Joints<double> VirtualArm::braking() const {
  const Parameters& p = options_.truth;
  Joints<double> torque;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double held = p.spring.stiffness[j] * (state_.theta[j] - state_.q[j]);
    const double braked = held - p.motor.inertia[j] * state_.dtheta[j] / kBraked;
    torque[j] = std::clamp(braked, -p.drive.peak_torque[j], p.drive.peak_torque[j]);
  }
  return torque;
}

// Simulates with a constant hysteresis torque. It acts like an offset of the spring: tau_c = K (theta + h z / K - q).
void VirtualArm::advance(const Joints<double>& torque, double duration) {
  const Hysteresis& h = options_.hysteresis;
  Joints<double> before;
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
