// A simulated arm: the exact model behind encoders, optionally with effects of a real arm that the model lacks.
#pragma once

#include <optional>

#include "model/dynamics.h"
#include "model/rig/rig.h"
#include "planner/certificate/rollout.h"
#include "planner/executor/arm.h"

namespace fjr {

struct EncoderFault {
  enum class Encoder { kQ1, kQ2, kTheta1, kTheta2 };
  Encoder encoder = Encoder::kTheta1;
  double above = 0;  // [rad/s] once the speed exceeds this, the encoder gives no more samples
};

struct VirtualArmOptions {
  Parameters truth;                       // parameters of the simulated arm, which may differ from the planner's
  Hysteresis hysteresis{{0, 0}, {1, 1}};  // of the springs; height 0: none
  double payload = 0;                     // [kg] a point mass at the tip, beside the truth's own
  std::optional<EncoderFault> fault{};
};

class VirtualArm : public Arm {
 public:
  // Begins at rest at q [rad].
  VirtualArm(const VirtualArmOptions& options, const Joints<double>& q);

  // Advances the simulation by so many ticks with the last commanded torque; after kStallTicks missed ticks the drives
  // brake. Nothing moves before the first command.
  Reading read(int ticks) override;
  void command(const Joints<double>& torque) override { torque_ = torque; }

  const State<double>& state() const { return state_; }

 private:
  void pass_tick(const Joints<double>& torque);
  void advance(const Joints<double>& torque, double duration);
  Joints<double> braking() const;
  Reading measure();

  VirtualArmOptions options_;
  Rollout rollout_;
  State<double> state_;
  std::optional<Joints<double>> torque_;  // [N m] commanded last
  Joints<double> z_{};                    // of the hysteresis, from -1 to 1
  bool faulty_ = false;
};

}  // namespace fjr
