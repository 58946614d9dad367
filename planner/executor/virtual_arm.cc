#include "planner/executor/virtual_arm.h"

#include <stdexcept>

#include "model/encoder.h"
#include "planner/certificate/tracking.h"

namespace fjr {

VirtualArm::VirtualArm(const Parameters& robot, const Pair<double>& q)
    : robot_(robot), rollout_(robot_, Limits{}, Accuracy::of_predictions()), state_(rest_at(robot_, q)) {}

Pair<double> VirtualArm::motor_positions() const {
  return {quantised(state_.theta[0], robot_.encoder.motor_counts[0]),
          quantised(state_.theta[1], robot_.encoder.motor_counts[1])};
}

Pair<double> VirtualArm::link_positions() const {
  return {quantised(state_.q[0], robot_.encoder.link_counts[0]), quantised(state_.q[1], robot_.encoder.link_counts[1])};
}

void VirtualArm::command(const Pair<double>& torque) {
  rollout_.start(0, state_, fjr::Drive::holding({0, {}, torque}));
  if (!rollout_.run(kTick, {}, {}, {})) throw std::runtime_error("the simulated arm: " + rollout_.failure());
  state_ = rollout_.state();
}

}  // namespace fjr
