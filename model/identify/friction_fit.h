// The friction law (24) through average torques at constant speeds.
//
//   tau(v) = B v + f tanh(v/eta) - g tanh(v/eta - h tanh(v/eta)),   g = f omega
//
// For given (eta, h) it is linear in (B, f, g): a grid over those two with linear fits finds every sensible start, and
// the best few are finished by nonlinear least squares. eta > 0, for (-f, -eta, omega, h) is the same law.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/friction.h"
#include "model/identify/fit.h"
#include "model/log.h"

namespace fjr {

struct FrictionPoint {
  double v, tau;              // [rad/s], [N m]
  double sigma_v, sigma_tau;  // standard errors of these averages
};

// Of the fitted parameters, in which the fit is well scaled.
enum FrictionIndex { kB, kF, kLogEta, kG, kAsinhH, kFrictionParameters };

inline constexpr double kLargestShape = 1e5;  // |h| beyond which nobody could measure

// h; where the points do not determine it, the search would run away.
double shape(const Eigen::VectorXd& p);
FrictionLaw law_of(const Eigen::VectorXd& p);

// Standard deviation of each point around the law: the torque's own, and the speed's by the law's slope (none: 0).
std::vector<double> deviations(const std::vector<FrictionPoint>& points, const FrictionLaw* law);

// Nonlinear least squares from `p`, with h free or kept; residuals in standard deviations sigma.
Fit finish(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Eigen::VectorXd& p,
           bool fix_h);

// Throws InputError naming the log when no law with positive f and B fits.
Fit best_of_many_starts(const Log& log, const std::vector<FrictionPoint>& points, const std::vector<double>& sigma);

// Residuals are in standard errors of the points, which the samples themselves tell: that the points happen to lie
// closer to the law than these allow makes it no more certain; that they lie farther off does make it less so.
void never_below_the_points(Fit& fit);

// Covariance of (B, f, eta, omega, h) from that of the fitted parameters.
Eigen::MatrixXd in_law_parameters(const Fit& fit);

}  // namespace fjr
