// A link that swings freely on its spring, the motor held:
//
//   ddq + d dq + k (q - offset) + c z = 0,   dz/dt = (1 - z sgn dq)^n dq / width
//
// with k = K/I, d = D/I, c = height/I of the hysteresis,
// which is (9) for c = 0. The hysteresis is Dahl's: n = 1 is also Bouc and Wen's model, n = 1/2 the Maxwell-slip model
// with evenly spread yields.
#pragma once

#include <Eigen/Core>

#include "model/identify/crests.h"
#include "model/identify/fit.h"

namespace fjr {

// Of the fitted parameters; the last three only with hysteresis, the last only where n = 1 does not explain the curve.
enum SwingIndex { kQ, kDq, kOffset, kK, kD, kC, kWidth, kExponent };
inline constexpr Eigen::Index kPlain = kC, kWithHysteresis = kWidth + 1, kWithExponent = kExponent + 1;

// From a start of kPlain or more parameters, which stay as many. The curve begins at a crest.
Fit fit_swing(const Curve& curve, const Eigen::VectorXd& start);

// From a fit without: with hysteresis where the plain oscillator leaves more than `resolution` [rad] explains, and only
// if that explains more.
Fit best_fit(const Curve& curve, const Fit& plain, double resolution);

// Whether the fit leaves more than the resolution explains.
bool is_unexplained(const Fit& fit, double resolution);

}  // namespace fjr
