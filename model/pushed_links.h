// Torques on the links beside springs and gravity: what a model lacks.
#pragma once

#include "model/dynamics.h"

namespace fjr {

// M(q2)^-1 torque: what they add to ddq. [N m] -> [rad/s^2]
template <class T>
Joints<T> acceleration_by(const Parameters& p, const T& q2, const Joints<double>& torque) {
  const MassMatrix<T> m = mass_matrix(p, q2);
  const T inverse_determinant = 1.0 / (m.m11 * m.m22 - m.m12 * m.m12);
  return {(m.m22 * torque[0] - m.m12 * torque[1]) * inverse_determinant,
          (m.m11 * torque[1] - m.m12 * torque[0]) * inverse_determinant};
}

}  // namespace fjr
