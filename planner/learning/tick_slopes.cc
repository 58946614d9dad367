#include "planner/learning/tick_slopes.h"

#include <algorithm>

#include "common/dual.h"
#include "model/friction.h"

namespace fjr {
namespace {

State<double> middle_of(const State<double>& a, const State<double>& b) {
  State<double> middle;
  for (std::size_t i = 0; i < kStates; ++i) middle[i] = 0.5 * (a[i] + b[i]);
  return middle;
}

// Returns M^-1, computed column by column.
Eigen::Matrix2d inverse_mass(const Parameters& robot, double q2) {
  const MassMatrix<double> m = mass_matrix(robot, q2);
  const Joints<double> first = accelerations(m, 1.0, 0.0), second = accelerations(m, 0.0, 1.0);
  return Eigen::Matrix2d{{first[0], second[0]}, {first[1], second[1]}};
}

StateMatrix rate_slopes(const Parameters& robot, const State<double>& begin, const State<double>& end,
                        const Joints<double>& torque, const LackingTorques& lacking, const Joints<double>& uncertain) {
  const State<double> middle = middle_of(begin, end);
  StateMatrix a = state_jacobian(robot, middle, torque);
  const Joints<Dual<1>> pushes =
      accelerations(mass_matrix(robot, Dual<1>::input(middle.q[1], 0)), lacking.link[0], lacking.link[1]);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto of_link = static_cast<Eigen::Index>(kStateDq + j),
               of_motor = static_cast<Eigen::Index>(kStateDtheta + j);
    a(of_link, kStateQ + 1) += pushes[j].g[0];
    const auto [slowest, fastest] = std::minmax(begin.dtheta[j], end.dtheta[j]);
    const FrictionLaw law = FrictionLaw::of(robot, static_cast<int>(j));
    a(of_motor, of_motor) = -law.mean_slope(slowest - uncertain[j], fastest + uncertain[j]) / robot.motor.inertia[j];
  }
  return a;
}

}  // namespace

std::optional<State<double>> LackingArm::advance(double from, double to, const State<double>& state,
                                                 const Joints<double>& torque, const LackingTorques& lacking) {
  rollout_.push_links(lacking.link);
  const Joints<double> both{torque[0] + lacking.motor[0], torque[1] + lacking.motor[1]};
  rollout_.start(from, state, Drive::holding({from, {}, both}));
  if (!rollout_.run(to, {}, {}, {})) return std::nullopt;
  return rollout_.state();
}

TickSlopes tick_slopes(const Parameters& robot, const State<double>& begin, const State<double>& end,
                       const Joints<double>& torque, const LackingTorques& lacking, double duration,
                       const Joints<double>& uncertain) {
  const Transition over = transition_over(rate_slopes(robot, begin, end, torque, lacking, uncertain), duration);
  TickSlopes slopes{over.start, {}, {}};
  for (Eigen::Index j = 0; j < kJoints; ++j) {
    slopes.torque.col(j) = over.input.col(kStateDtheta + j) / robot.motor.inertia[static_cast<std::size_t>(j)];
  }
  slopes.lacking.leftCols<kJoints>() =
      over.input.middleCols<kJoints>(kStateDq) * inverse_mass(robot, 0.5 * (begin.q[1] + end.q[1]));
  slopes.lacking.rightCols<kJoints>() = slopes.torque;
  return slopes;
}

}  // namespace fjr
