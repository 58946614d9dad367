// Fits the friction law (24) to average torques at constant speeds.
//
//   tau(v) = B v + f tanh(v/eta) - g tanh(v/eta - h tanh(v/eta)),   g = f omega
//
// For given (eta, h) it is linear in (B, f, g). Therefore a grid over these two with linear fits gives all sensible
// starts, and the best few are refined by nonlinear least squares. eta > 0 can be required, because (-f, -eta, omega,
// h) gives the same law.
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

// Indices of the fitted parameters, which are chosen for good scaling.
enum FrictionIndex { kB, kF, kLogEta, kG, kAsinhH, kFrictionParameters };

inline constexpr double kLargestShape = 1e5;  // larger |h| cannot be measured

// Returns h, limited to kLargestShape. Otherwise the search would diverge if the points do not determine it.
double shape(const Eigen::VectorXd& p);
FrictionLaw law_of(const Eigen::VectorXd& p);

// Returns the standard deviation of each point around the law: that of the torque, combined with that of the speed
// times the slope of the law (0 without a law).
std::vector<double> deviations(const std::vector<FrictionPoint>& points, const FrictionLaw* law);

// Nonlinear least squares from `p`, with h free or kept; residuals in standard deviations sigma.
Fit finish(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Eigen::VectorXd& p,
           bool fix_h);

// Throws InputError naming the log when no law with positive f and B fits.
Fit best_of_many_starts(const Log& log, const std::vector<FrictionPoint>& points, const std::vector<double>& sigma);

// Keeps the uncertainty at least as large as the standard errors of the points, which are estimated from the samples.
// If the points happen to lie closer to the law, the result is not more certain; if they lie farther off, it is less
// certain.
void never_below_the_points(Fit& fit);

// Returns the covariance of (B, f, eta, omega, h), from that of the fitted parameters.
Eigen::MatrixXd in_law_parameters(const Fit& fit);

}  // namespace fjr
