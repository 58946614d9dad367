#include "planner/identify/drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "model/uncertainty.h"
#include "planner/identify/readings.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUnit = 0.01;                       // fraction of a parameter's value that is z = 1
constexpr double kPayloadUnit = 0.01;                // [kg]
constexpr std::array<double, 3> kSizes{0.1, 1, 10};  // standard deviations of a change, in z
constexpr std::size_t kRemembered = 256;             // number of motions that may be the first with a change
// Factor by which the information is reduced, because quantisation errors of neighbouring readings are not independent
// where a link moves slowly. Over 60 motions of the known arm, the variance of the scores was 0.9 to 2.5 times that of
// independent errors.
constexpr double kNeighbours = 4;
constexpr int kLooks = 3;             // largest number of linearisations per motion
constexpr double kSameSlopes = 0.01;  // in z; a smaller move of the expansion point changes slopes by less than 1e-4
constexpr double kMostLog = 700;      // largest exponent for which exp() does not overflow

double usual_deviation(const Parameters& robot, const std::string& name, double otherwise) {
  if (name == "payload.mass") return kPayloadUnit;
  Parameters p = robot;
  const double value = std::abs(*parameter_named(p, name));
  return value > 0 ? kUnit * value : otherwise;
}

// The contribution of a motion to information matrix and score, expanded about z = 0.
struct Evidence {
  MatrixXd matrix;
  VectorXd score;
};

Evidence evidence_of(const DriftTest::Look& look) {
  const double scale = 1 / (kNeighbours * std::max(1.0, look.told.chi_square));
  return {scale * look.told.matrix, scale * (look.told.score + look.told.matrix * look.about)};
}

}  // namespace

DriftParameters drift_parameters(const Parameters& robot) {
  const Prior usual = prior_of(robot);
  const Uncertainty uncertain = uncertainty_of(robot);
  DriftParameters all;
  for (const std::string& name : usually_told(robot)) all.of.names.push_back(name);
  all.candidates = all.of.names.size();
  for (const std::string& name : uncertain.names) {
    if (std::find(all.of.names.begin(), all.of.names.end(), name) == all.of.names.end()) all.of.names.push_back(name);
  }
  const auto n = static_cast<Index>(all.of.names.size());
  all.of.assumed.assign(all.of.names.size(), false);
  all.of.deviation.resize(n);
  for (Index i = 0; i < n; ++i) {
    const std::string& name = all.of.names[static_cast<std::size_t>(i)];
    const auto place = std::find(usual.names.begin(), usual.names.end(), name) - usual.names.begin();
    all.of.deviation[i] = usual_deviation(robot, name, usual.deviation[place]);
  }
  all.of.factor = all.of.deviation.asDiagonal();
  return all;
}

DriftTest::DriftTest(const Parameters& robot) : robot_(robot), parameters_(drift_parameters(robot)) {
  const Prior& of = parameters_.of;
  const auto n = static_cast<Index>(of.names.size());
  const Uncertainty uncertain = uncertainty_of(robot);
  const MatrixXd factor = uncertain.none() ? MatrixXd(0, 0) : uncertain.factor();
  known_ = MatrixXd::Zero(n, factor.cols());
  for (std::size_t i = 0; i < uncertain.names.size(); ++i) {
    const auto row = std::find(of.names.begin(), of.names.end(), uncertain.names[i]) - of.names.begin();
    known_.row(row) = factor.row(static_cast<Index>(i)) / of.deviation[row];
  }
  all_matrix_ = MatrixXd::Zero(n, n);
  all_score_ = VectorXd::Zero(n);
  expected_ = expected(all_matrix_, all_score_);
}

DriftTest::Expected DriftTest::expected(const MatrixXd& matrix, const VectorXd& score) const {
  const Index r = known_.cols();
  const MatrixXd of_xi = MatrixXd::Identity(r, r) + known_.transpose() * matrix * known_;
  Expected e;
  e.covariance = known_ * of_xi.ldlt().solve(MatrixXd(known_.transpose()));
  e.mean = e.covariance * score;
  return e;
}

std::optional<DriftTest::Look> DriftTest::look_at(const ExecutedMotion& motion, const ForEach& for_each,
                                                  const std::function<bool()>& stopped) const {
  Look look;
  look.about = expected_.mean;
  for (int i = 0; i < kLooks; ++i) {
    const Parameters about = moved(robot_, parameters_.of.names, parameters_.of.factor * look.about);
    auto told = information_of(about, parameters_.of, motion, for_each, stopped);
    if (!told) return std::nullopt;
    look.told = *std::move(told);
    const Evidence evidence = evidence_of(look);
    const Expected then = expected(all_matrix_ + evidence.matrix, all_score_ + evidence.score);
    if ((then.mean - look.about).cwiseAbs().maxCoeff() < kSameSlopes || i + 1 == kLooks) break;
    look.about = then.mean;
  }
  return look;
}

void DriftTest::add(const Look& look) {
  const Evidence evidence = evidence_of(look);
  const Index n = all_score_.size();
  changes_.push_back({motions_++, MatrixXd::Zero(n, n), VectorXd::Zero(n)});
  if (changes_.size() > kRemembered) changes_.pop_front();
  for (Change& change : changes_) {
    change.matrix += evidence.matrix;
    change.score += evidence.score;
  }
  all_matrix_ += evidence.matrix;
  all_score_ += evidence.score;
  expected_ = expected(all_matrix_, all_score_);
}

// Returns the logarithm of the likelihood ratio of a change of a parameter i, z = known xi + delta e_i since the
// change, against z = known xi, with xi and delta integrated out; and the mean and standard deviation of delta. s is
// the information of delta after xi is eliminated, with that of its prior, and b the score.
DriftTest::Likelihood DriftTest::likelihood(const Change& change, Index candidate, double size) const {
  const auto column = change.matrix.col(candidate);
  const double s = std::max(0.0, column[candidate] - column.dot(expected_.covariance * column)) + 1 / (size * size);
  const double b = change.score[candidate] - column.dot(expected_.mean);
  return {0.5 * b * b / s - 0.5 * std::log(s * size * size), b / s, 1 / std::sqrt(s)};
}

template <class Visit>
void DriftTest::visit(Visit&& visit) const {
  const double weight = 1 / static_cast<double>(parameters_.candidates * kSizes.size());
  for (const Change& change : changes_) {
    for (std::size_t i = 0; i < parameters_.candidates; ++i) {
      for (const double size : kSizes) {
        const Likelihood l = likelihood(change, static_cast<Index>(i), size);
        visit(change, i, l, weight * std::exp(std::min(kMostLog, l.log_ratio)));
      }
    }
  }
}

double DriftTest::evidence() const {
  double sum = 0;
  visit([&](const Change&, std::size_t, const Likelihood&, double evidence) { sum += evidence; });
  return sum;
}

std::optional<DriftCause> DriftTest::cause() const {
  if (changes_.empty()) return std::nullopt;
  // Subtract the largest logarithm before exp(), so that the likeliest cause is found even if several would overflow.
  double largest = -kMostLog;
  visit([&](const Change&, std::size_t, const Likelihood& l, double) { largest = std::max(largest, l.log_ratio); });
  std::vector<double> of_candidate(parameters_.candidates, 0);
  double sum = 0;
  visit([&](const Change&, std::size_t i, const Likelihood& l, double) {
    of_candidate[i] += std::exp(l.log_ratio - largest);
    sum += std::exp(l.log_ratio - largest);
  });
  const auto best =
      static_cast<std::size_t>(std::max_element(of_candidate.begin(), of_candidate.end()) - of_candidate.begin());
  DriftCause cause;
  cause.parameter = parameters_.of.names[best];
  cause.unit = unit_of(cause.parameter);
  cause.share = of_candidate[best] / sum;
  Parameters p = robot_;
  cause.known = *parameter_named(p, cause.parameter);
  double likeliest = -kMostLog;
  visit([&](const Change& change, std::size_t i, const Likelihood& l, double) {
    if (i != best || l.log_ratio < likeliest) return;
    likeliest = l.log_ratio;
    const double unit = parameters_.of.deviation[static_cast<Index>(best)];
    cause.since = change.first;
    cause.change = unit * l.change;
    cause.error = unit * l.deviation;
  });
  return cause;
}

}  // namespace fjr
