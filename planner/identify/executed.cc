#include "planner/identify/executed.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "common/input_error.h"
#include "model/identify/fit.h"
#include "planner/identify/readings.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBlocks = 5;  // blocks of neighbouring readings per piece

// Returns the covariance of the parameters. It grows by chi^2 if residuals are larger than quantisation explains. It
// also grows to the standard errors of the sandwich estimator with blocks of readings as clusters (Liang & Zeger,
// Biometrika 73, 1986) if these are larger, because residuals of neighbouring readings are correlated.
MatrixXd covariance_of(const Readings& readings, const Fit& fit, const MatrixXd& factor, double chi_square) {
  const auto j = fit.jacobian.topRows(readings.readings());
  const auto r = fit.residuals.head(readings.readings());
  const Index n = readings.unknowns(), blocks = kBlocks * static_cast<Index>(readings.pieces());
  const MatrixXd information = j.transpose() * j, one = MatrixXd::Identity(n, n);
  const MatrixXd by_counts = (information + one).ldlt().solve(one);
  const MatrixXd all = (information / std::max(1.0, chi_square) + one).ldlt().solve(one);
  MatrixXd scores(blocks + n, n);
  scores.bottomRows(n) = one;
  for (Index k = 0; k < blocks; ++k) {
    const auto piece = static_cast<std::size_t>(k / kBlocks);
    const Index block = k % kBlocks, count = readings.count(piece), first = readings.first(piece);
    const Index from = first + block * count / kBlocks, rows = first + (block + 1) * count / kBlocks - from;
    scores.row(k) = r.segment(from, rows).transpose() * j.middleRows(from, rows);
  }
  const MatrixXd root = scores * by_counts.leftCols(factor.cols()) * factor.transpose();  // sandwich = root' root
  MatrixXd covariance = factor * all.topLeftCorner(factor.cols(), factor.cols()) * factor.transpose();
  for (Index i = 0; i < covariance.rows(); ++i) {
    const double grown = std::sqrt(std::max(1.0, root.col(i).squaredNorm() / covariance(i, i)));
    covariance.row(i) *= grown;
    covariance.col(i) *= grown;
  }
  return covariance;
}

// Returns the most likely change with which no payload and damping is negative: those that would be are 0, and the
// others follow by the covariance. By Hildreth's method (Quarterly of Applied Mathematics 4, 1957), in which `push` are
// the multipliers of the bounds.
void bound(const std::vector<std::string>& names, const Parameters& known, const MatrixXd& covariance,
           VectorXd& change) {
  constexpr int kMostSweeps = 1000;  // each reduces the error by the square of a correlation
  constexpr double kSmall = 1e-12;   // [standard errors]
  Parameters p = known;
  VectorXd least = VectorXd::Constant(change.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!names[i].starts_with("payload.") && !names[i].starts_with("link.damping")) continue;
    least[static_cast<Index>(i)] = -*parameter_named(p, names[i]);
  }
  VectorXd push = VectorXd::Zero(change.size());
  double moved = 1;
  for (int sweep = 0; sweep < kMostSweeps && moved > kSmall; ++sweep) {
    moved = 0;
    for (Index i = 0; i < change.size(); ++i) {
      if (std::isinf(least[i]) || !(covariance(i, i) > 0)) continue;
      const double by = std::max(-push[i], (least[i] - change[i]) / covariance(i, i));
      push[i] += by;
      change += by * covariance.col(i);
      moved = std::max(moved, std::abs(by) * std::sqrt(covariance(i, i)));
    }
  }
  change = change.cwiseMax(least);  // rounding leaves none below
}

// Returns the rms residuals [rad] per motion and encoder.
std::vector<Eigen::Vector4d> rms_of(const Readings& readings, const VectorXd& residuals, std::size_t motions,
                                    const Eigen::Vector4d& noise) {
  std::vector<Eigen::Vector4d> sums(motions, Eigen::Vector4d::Zero());
  std::vector<double> rows(motions, 0);
  for (std::size_t i = 0; i < readings.pieces(); ++i) {
    const auto off = residuals.segment(readings.first(i), readings.count(i)).reshaped(4, readings.count(i) / 4);
    sums[readings.motion_of(i)] += off.rowwise().squaredNorm();
    rows[readings.motion_of(i)] += static_cast<double>(off.cols());
  }
  for (std::size_t i = 0; i < motions; ++i) {
    sums[i] = (sums[i] / std::max(rows[i], 1.0)).cwiseSqrt().cwiseProduct(noise);
  }
  return sums;
}

std::vector<RefinedParameter> parameters_of(const Parameters& known, const Prior& prior, const VectorXd& change,
                                            const MatrixXd& covariance) {
  std::vector<RefinedParameter> all;
  Parameters before = known;
  for (std::size_t i = 0; i < prior.names.size(); ++i) {
    const auto row = static_cast<Index>(i);
    RefinedParameter p;
    p.name = prior.names[i];
    p.unit = unit_of(p.name);
    p.before = *parameter_named(before, p.name);
    p.prior_error = prior.deviation[row];
    p.assumed = prior.assumed[i];
    p.after = p.before + change[row];
    p.error = std::sqrt(covariance(row, row));
    all.push_back(p);
  }
  return all;
}

}  // namespace

ExecutedFit fit_executed(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
                         const ForEach& for_each) {
  const Readings readings(known, prior, motions, for_each);
  if (readings.pieces() == 0) {
    throw InputError(motions.front().log, "", "in none of the motions do the motors move for long enough");
  }
  VectorXd start = VectorXd::Zero(readings.unknowns()), before(readings.size());
  if (!readings.fit_starts(start) || !readings.fill(start, before, nullptr)) {
    throw InputError(motions.front().log, "",
                     "the arm of the robot file cannot be rolled out under the torques of the logs");
  }
  const Fit fit = curve_fit(
      SlopedResiduals([&](const VectorXd& x, VectorXd& r, MatrixXd* slopes) { return readings.fill(x, r, slopes); }),
      readings.size(), start);
  if (!fit.residuals.allFinite()) throw std::runtime_error("the fit left what can be rolled out");
  ExecutedFit found;
  found.converged = fit.determined;
  found.readings = readings.readings();
  found.chi_square = fit.residuals.squaredNorm() / static_cast<double>(readings.readings());
  found.covariance = covariance_of(readings, fit, prior.factor, found.chi_square);
  VectorXd change = prior.factor * fit.value.head(readings.parameters());
  bound(prior.names, known, found.covariance, change);
  found.robot = moved(known, prior.names, change);
  found.parameters = parameters_of(known, prior, change, found.covariance);
  const Eigen::Vector4d noise = count_deviation(known);
  const auto off_before = rms_of(readings, before, motions.size(), noise);
  const auto off_after = rms_of(readings, fit.residuals, motions.size(), noise);
  for (std::size_t i = 0; i < motions.size(); ++i) found.motions.push_back({off_before[i], off_after[i]});
  return found;
}

}  // namespace fjr
