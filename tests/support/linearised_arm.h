// The arm at rest, linearised by differences.
#pragma once

#include <Eigen/Dense>

#include "support/exact_trajectories.h"

namespace fjr {

// Jacobian at rest of the complete arm without the nonlinear friction, by central differences.
inline Eigen::MatrixXd linearised_arm(const Joints<double>& q) {
  const State<double> rest = rest_at(robot(), q);
  const Joints<double> u = gravity_torque(robot(), q);
  Eigen::MatrixXd a(kStates, kStates);
  for (int i = 0; i < kStates; ++i) {
    State<double> up = rest, down = rest;
    up[i] += 1e-5;
    down[i] -= 1e-5;
    const State<double> f1 = compensated_dynamics(robot(), up, u), f0 = compensated_dynamics(robot(), down, u);
    for (int k = 0; k < kStates; ++k) a(k, i) = (f1[k] - f0[k]) / 2e-5;
  }
  return a;
}

}  // namespace fjr
