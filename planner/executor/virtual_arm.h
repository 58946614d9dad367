// The exact model behind its encoders.
#pragma once

#include "model/dynamics.h"
#include "planner/certificate/rollout.h"
#include "planner/executor/arm.h"

namespace fjr {

class VirtualArm : public Arm {
 public:
  // At rest at q [rad].
  VirtualArm(const Parameters& robot, const Pair<double>& q);

  Pair<double> motor_positions() const override;
  Pair<double> link_positions() const override;
  void command(const Pair<double>& torque) override;  // time goes on by one tick

  const State<double>& state() const { return state_; }

 private:
  Parameters robot_;
  Rollout rollout_;
  State<double> state_;
};

}  // namespace fjr
