// Simulates the arm under lacking torques over a tick, and linearises the result.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "model/variational.h"
#include "planner/certificate/rollout.h"

namespace fjr {

// Torques [N m] that act on the arm in addition to those of the model.
struct LackingTorques {
  Joints<double> link{}, motor{};
};

// The model with lacking torques, tick by tick.
class LackingArm {
 public:
  explicit LackingArm(const Parameters& robot) : rollout_(robot, Limits{}, Accuracy::of_predictions()) {}

  // Returns the state at the time `to` [s], starting from `state` at `from` [s], under a constant motor torque [N m]
  // and constant lacking torques. Returns nothing if the integration fails.
  std::optional<State<double>> advance(double from, double to, const State<double>& state, const Joints<double>& torque,
                                       const LackingTorques& lacking);

 private:
  Rollout rollout_;
};

// First derivatives of the state at the end of a tick by the state at its beginning, by the motor torque, and by the
// lacking torques of links and motors, which are constant during the tick.
struct TickSlopes {
  StateMatrix state;
  Eigen::Matrix<double, kStates, kJoints> torque;
  Eigen::Matrix<double, kStates, 2 * kJoints> lacking;
};

// Computes the derivatives by the variational equation with the model's slopes in the middle of the tick. The slope of
// friction is the mean over the range of velocities in the tick, extended by `uncertain` [rad/s] on both sides. If it
// is uncertain on which side of a kink the motor is, the mean slope is the right one (statistical linearisation: Gelb,
// Applied Optimal Estimation, 1974, section 6.2). duration: [s].
TickSlopes tick_slopes(const Parameters& robot, const State<double>& begin, const State<double>& end,
                       const Joints<double>& torque, const LackingTorques& lacking, double duration,
                       const Joints<double>& uncertain = {});

}  // namespace fjr
