#include "model/variational.h"

#include <unsupported/Eigen/MatrixFunctions>

#include "common/dual.h"
#include "model/dynamics.h"

namespace fjr {

StateMatrix state_jacobian(const Parameters& p, const State<double>& x, const Joints<double>& torque) {
  using Active = Dual<kStates>;
  State<Active> active;
  for (std::size_t i = 0; i < kStates; ++i) active[i] = Active::input(x[i], static_cast<int>(i));
  const State<Active> f = dynamics<Active>(p, active, {Active(torque[0]), Active(torque[1])});
  StateMatrix jacobian;
  for (std::size_t row = 0; row < kStates; ++row) {
    for (std::size_t column = 0; column < kStates; ++column) {
      jacobian(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = f[row].g[column];
    }
  }
  return jacobian;
}

Transition transition_over(const StateMatrix& a, double duration) {
  using Both = Eigen::Matrix<double, 2 * kStates, 2 * kStates>;
  Both generator = Both::Zero();
  generator.topLeftCorner<kStates, kStates>() = duration * a;
  generator.topRightCorner<kStates, kStates>().diagonal().setConstant(duration);
  const Both exponential = generator.exp();
  return {exponential.topLeftCorner<kStates, kStates>(), exponential.topRightCorner<kStates, kStates>()};
}

}  // namespace fjr
