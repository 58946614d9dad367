// The interpolation between two published rows, as polynomials with rigorous coefficients.
#pragma once

#include "common/enclosure/flow.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Polynomials of the time since the first of the two rows: positions are cubic, velocities their derivatives, torques
// linear, the same functions that Interpolator evaluates in floating point.
struct RowPolynomials {
  enclosure::Ball duration;
  State<enclosure::Polynomial> state;
  Joints<enclosure::Polynomial> torque;

  static RowPolynomials between(const Sample& from, const Sample& to);
  // Returns the polynomials of the time since `by` later; the duration stays.
  RowPolynomials shifted(const enclosure::Ball& by) const;
};

}  // namespace fjr
