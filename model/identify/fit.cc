#include "model/identify/fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

constexpr double kOutlier = 6;          // robust standard deviations
constexpr Eigen::Index kBlocks = 20;    // of neighbouring residuals
constexpr double kUndetermined = 1e-9;  // relative pivot of a column-scaled Jacobian

Eigen::VectorXd column_norms(const Eigen::MatrixXd& a) {
  Eigen::VectorXd norms = a.colwise().norm();
  for (double& norm : norms) norm = norm > 0 ? norm : 1;
  return norms;
}

}  // namespace

void add_uncertainty(Fit& fit) {
  const Eigen::MatrixXd& jacobian = fit.jacobian;
  const Eigen::Index m = jacobian.rows(), n = jacobian.cols();
  const Eigen::VectorXd scale = column_norms(jacobian);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian * scale.cwiseInverse().asDiagonal());
  qr.setThreshold(kUndetermined);
  fit.determined = qr.rank() == n && m > n;
  const double degrees = static_cast<double>(std::max<Eigen::Index>(m - n, 1));
  const double variance = fit.residuals.squaredNorm() / degrees;
  fit.residual_rms = std::sqrt(fit.residuals.squaredNorm() / static_cast<double>(m));
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  if (!fit.determined) return;
  const Eigen::MatrixXd r = qr.matrixR().topRows(n);
  const Eigen::MatrixXd inverse =
      r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));  // of R; (J'J)^-1 = P R^-1 R^-T P'
  const Eigen::MatrixXd unscaled = qr.colsPermutation() * inverse;
  const Eigen::MatrixXd root = scale.cwiseInverse().asDiagonal() * unscaled;
  fit.covariance = variance * root * root.transpose();
}

Fit linear_fit(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd scale = column_norms(a);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a * scale.cwiseInverse().asDiagonal());
  Fit fit;
  fit.value = scale.cwiseInverse().asDiagonal() * qr.solve(b);
  fit.residuals = a * fit.value - b;
  fit.jacobian = a;
  add_uncertainty(fit);
  return fit;
}

void allow_for_correlation(Fit& fit) {
  const Eigen::Index m = fit.jacobian.rows(), n = fit.jacobian.cols();
  if (!fit.determined || m < 5 * kBlocks) return;
  Eigen::MatrixXd scores(kBlocks, n);
  for (Eigen::Index block = 0; block < kBlocks; ++block) {
    const Eigen::Index from = block * m / kBlocks, rows = (block + 1) * m / kBlocks - from;
    scores.row(block) = fit.residuals.segment(from, rows).transpose() * fit.jacobian.middleRows(from, rows);
  }
  const double variance = fit.residuals.squaredNorm() / static_cast<double>(m - n);
  if (!(variance > 0)) return;
  const Eigen::MatrixXd root = scores * fit.covariance / variance;  // sandwich = root' root
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sandwich = root.col(i).squaredNorm() * kBlocks / (kBlocks - 1.0);
    const double grown = std::sqrt(std::max(sandwich / fit.covariance(i, i), 1.0));
    fit.covariance.row(i) *= grown;
    fit.covariance.col(i) *= grown;
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<bool> inliers(std::span<const double> values, double floor) {
  const double centre = median({values.begin(), values.end()});
  std::vector<double> deviations;
  for (const double v : values) deviations.push_back(std::abs(v - centre));
  const double allowed = std::max(kOutlier * kMadToSigma * median(deviations), floor);
  std::vector<bool> inside;
  for (const double deviation : deviations) inside.push_back(deviation <= allowed);
  return inside;
}

Average robust_mean(std::span<const double> values) {
  // Readings of an encoder may repeat and have no spread. Then one that differs by a count must not count as an
  // outlier.
  double mean_deviation = 0;
  const double centre = median({values.begin(), values.end()});
  for (const double v : values) mean_deviation += std::abs(v - centre) / static_cast<double>(values.size());
  const std::vector<bool> inside = inliers(values, std::min(mean_deviation * kOutlier, 1e-2));
  double sum = 0, square = 0, count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!inside[i]) continue;
    sum += values[i] - centre;
    square += (values[i] - centre) * (values[i] - centre);
    ++count;
  }
  Average average;
  const double offset = count > 0 ? sum / count : 0;
  average.mean = centre + offset;
  if (count > 1) average.standard_error = std::sqrt(std::max(square / count - offset * offset, 0.0) / (count - 1));
  average.rejected = values.size() - static_cast<std::size_t>(count);
  return average;
}

}  // namespace fjr
