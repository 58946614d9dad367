// The arm under torques that its model lacks, over a tick: where it goes, and the slopes of that.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "model/variational.h"
#include "planner/certificate/rollout.h"

namespace fjr {

// What acts on an arm beside its model. [N m]
struct LackingTorques {
  Joints<double> link{}, motor{};
};

// The model with lacking torques, tick by tick.
class LackingArm {
 public:
  explicit LackingArm(const Parameters& robot) : rollout_(robot, Limits{}, Accuracy::of_predictions()) {}

  // From `state` under a motor torque and lacking torques that are held for the tick. Nothing: the integration broke
  // down. Times [s], torque [N m].
  std::optional<State<double>> advance(double from, double to, const State<double>& state, const Joints<double>& torque,
                                       const LackingTorques& lacking);

 private:
  Rollout rollout_;
};

// Of the state at the end of a tick, to first order: by the state at its beginning, by the motor torque that is held
// during it, and by the lacking torques, of links and of motors.
struct TickSlopes {
  StateMatrix state;
  Eigen::Matrix<double, kStates, kJoints> torque;
  Eigen::Matrix<double, kStates, 2 * kJoints> lacking;
};

// By the variational equation with the model's slopes in the middle of the tick. Friction's slope is the mean over the
// velocities that the motor passes through, and `uncertain` [rad/s] beyond them: a motor of which nobody knows on which
// side of a kink it is feels neither side's slope (statistical linearisation: Gelb, Applied Optimal Estimation, 1974,
// section 6.2). duration [s].
TickSlopes tick_slopes(const Parameters& robot, const State<double>& begin, const State<double>& end,
                       const Joints<double>& torque, const LackingTorques& lacking, double duration,
                       const Joints<double>& uncertain = {});

}  // namespace fjr
