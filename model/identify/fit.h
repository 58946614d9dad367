// Linear and nonlinear least squares with uncertainties.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fjr {

// covariance = s^2 (J' J)^-1 with s^2 = |r|^2 / (m - n) and J the Jacobian of the residuals r (m) in the value (n):
// linear theory, exact for a linear model with independent residuals of one variance.
struct Fit {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double residual_rms = 0;
  bool determined = true;  // false: the data do not determine some direction, and the covariance is meaningless
};

// argmin |A x - b|^2 by rank-revealing QR of the column-scaled A (m x n), never by normal equations.
Fit linear_fit(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// argmin |r(x)|^2 from `start`. `residuals` fills its second argument, of size `size`. By Ceres (Levenberg-Marquardt,
// central differences), the one place that knows it.
using Residuals = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& r)>;
Fit curve_fit(const Residuals& residuals, Eigen::Index size, const Eigen::VectorXd& start);

// Least squares with a user-supplied Jacobian: `residuals` fills r and, if not null, their Jacobian; it returns false
// if they cannot be evaluated. The iteration ends when a step changes |r|^2 by less than a fraction of 1e-6, since such
// residuals are expensive.
using SlopedResiduals = std::function<bool(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* jacobian)>;
Fit curve_fit(const SlopedResiduals& residuals, Eigen::Index size, const Eigen::VectorXd& start);

// Fills covariance, residual_rms and determined from Jacobian and residuals at the minimum.
void add_uncertainty(Fit& fit);

// Accounts for the correlation of residuals that are ordered in time, which arises from model errors. The standard
// errors are increased to those of the sandwich estimator with blocks of neighbours as clusters (Liang & Zeger,
// Biometrika 73, 1986), but never reduced.
void allow_for_correlation(Fit& fit);

// Marks the values that are not outliers: those within 6 robust standard deviations (1.4826 MAD) of the median.
// `floor`: deviations up to this never count as outliers.
std::vector<bool> inliers(std::span<const double> values, double floor);

double median(std::vector<double> values);
inline constexpr double kMadToSigma = 1.4826;  // median absolute deviation to sigma, for normally distributed values

// Mean without outliers.
struct Average {
  double mean = 0, standard_error = 0;
  std::size_t rejected = 0;
};
Average robust_mean(std::span<const double> values);

}  // namespace fjr
