// Fits the free oscillation of a link on its spring with the motor held:
//
//   ddq + d dq + k (q - offset) + c z = 0,   dz/dt = (1 - z sgn dq)^n dq / width
//
// with k = K/I, d = D/I, c = height/I of the hysteresis,
// which is (9) for c = 0. The hysteresis is Dahl's: n = 1 is also Bouc and Wen's model, n = 1/2 the Maxwell-slip model
// with evenly spread yields.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/identify/crests.h"
#include "model/identify/fit.h"

namespace fjr {

// Indices of the fitted parameters. The last three are used only with hysteresis, the last only if n = 1 does not
// explain the curve.
enum SwingIndex { kQ, kDq, kOffset, kK, kD, kC, kWidth, kExponent };
inline constexpr Eigen::Index kPlain = kC, kWithHysteresis = kWidth + 1, kWithExponent = kExponent + 1;

// A free decay with the line that was fitted to the logarithm of its crests, and the residuals of the fitted swing.
struct FittedDecay {
  Curve whole;                // of the log, as it was measured
  std::vector<Crest> crests;  // all of them
  Eigen::Vector2d line;       // (12): intercept and slope [1/s] of the logarithm of the crests [rad] over the time
  Curve decay;                // from the first crest to the last, without outliers
  Eigen::VectorXd residuals;  // [rad] of the decay, fitted less measured
};

// Fits as many parameters as `start` has, at least kPlain. The curve must begin at a crest.
Fit fit_swing(const Curve& curve, const Eigen::VectorXd& start);

// Returns the plain fit if `resolution` [rad] explains its residuals (is_unexplained()). Otherwise returns a fit with
// hysteresis, or with exponent if even that leaves more, but only if it explains more than the simpler one.
Fit best_fit(const Curve& curve, const Fit& plain, double resolution);

// Returns whether the residuals are larger than the resolution explains.
bool is_unexplained(const Fit& fit, double resolution);

}  // namespace fjr
