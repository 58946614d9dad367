#include "planner/identify/executed.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "common/input_error.h"
#include "model/identify/fit.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLongestStep = 0.25;    // of a prior's standard deviation
constexpr double kStepOfStart = 0.0005;  // of kOffGuess
constexpr Index kBlocks = 5;             // of neighbouring readings of a piece

std::string unit_of(const std::string& name) {
  if (name == "payload.mass") return "kg";
  if (name == "payload.inertia") return "kg m^2";
  std::string found;
  const Parameters any{};
  visit_parameters(any, [&](const std::string& section, const std::string& entry, const char* unit, const auto&) {
    if (name.starts_with(section + "." + entry + "[")) found = unit;
  });
  return found;
}

// Without the bounds of changed(): a mass below none is a mean to find one that is hardly there.
Parameters moved(const Parameters& known, const std::vector<std::string>& names, const VectorXd& by) {
  Parameters p = known;
  for (std::size_t i = 0; i < names.size(); ++i) *parameter_named(p, names[i]) += by[static_cast<Index>(i)];
  return p;
}

// Steps of the prior's independent numbers, which move no parameter by more than kSlopeStep of its size.
VectorXd steps_of(const Parameters& known, const Prior& prior) {
  Parameters p = known;
  VectorXd sizes(prior.factor.rows());
  for (Index i = 0; i < sizes.size(); ++i) {
    const std::string& name = prior.names[static_cast<std::size_t>(i)];
    const double value = std::abs(*parameter_named(p, name));
    sizes[i] = value > 0 ? value : prior.deviation[i];
  }
  VectorXd steps(prior.factor.cols());
  for (Index i = 0; i < steps.size(); ++i) {
    const double largest = (prior.factor.col(i).cwiseAbs().array() / sizes.array()).maxCoeff();
    steps[i] = std::min(kLongestStep, kSlopeStep / largest);
  }
  return steps;
}

// How far a piece begins off what was guessed, one standard deviation: so far that the readings alone decide. [rad],
// [rad/s]
const State<double> kOffGuess{{0.02, 0.02}, {0.5, 0.5}, {0.02, 0.02}, {0.5, 0.5}};

// All motions at one arm, in pieces. Unknown are the prior's independent numbers z, then what each piece begins off its
// guess, in kOffGuess. Residuals are the readings of each piece, then the unknown themselves.
class Readings {
 public:
  Readings(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
           const ForEach& for_each)
      : known_(known),
        prior_(prior),
        motions_(motions),
        for_each_(for_each),
        steps_(steps_of(known, prior)),
        noise_(count_deviation(known)) {
    for (std::size_t i = 0; i < motions.size(); ++i) {
      for (const Piece& piece : pieces_of(known, motions[i], i)) {
        pieces_.push_back(piece);
        first_.push_back(readings_);
        readings_ += count(pieces_.size() - 1);
      }
    }
  }

  std::size_t pieces() const { return pieces_.size(); }
  std::size_t motion_of(std::size_t piece) const { return pieces_[piece].motion; }
  Index parameters() const { return prior_.factor.cols(); }
  Index unknowns() const { return parameters() + kStates * static_cast<Index>(pieces_.size()); }
  Index readings() const { return readings_; }
  Index size() const { return readings_ + unknowns(); }
  Index first(std::size_t piece) const { return first_[piece]; }
  Index count(std::size_t piece) const { return 4 * static_cast<Index>(pieces_[piece].count); }
  Index start_column(std::size_t piece) const { return parameters() + kStates * static_cast<Index>(piece); }

  Parameters robot_at(const VectorXd& x) const {
    return moved(known_, prior_.names, prior_.factor * x.head(parameters()));
  }

  // Positions less readings, in standard deviations of a count.
  std::optional<VectorXd> off(const Parameters& robot, const VectorXd& x, std::size_t piece) const {
    const Piece& at = pieces_[piece];
    const ExecutedMotion& m = motions_[at.motion];
    State<double> start = at.begins;
    for (Index i = 0; i < kStates; ++i) {
      const auto k = static_cast<std::size_t>(i);
      start[k] += kOffGuess[k] * x[start_column(piece) + i];
    }
    std::optional<VectorXd> r = replayed(robot, m, at, start);
    if (!r) return r;
    for (std::size_t k = 0; k < at.count; ++k) {
      const std::size_t row = at.first + k;
      auto of_row = r->segment<4>(4 * static_cast<Index>(k));
      of_row -= Eigen::Vector4d(m.q[row][0], m.q[row][1], m.theta[row][0], m.theta[row][1]);
      of_row.array() /= noise_.array();
    }
    return r;
  }

  // All residuals, and their slopes by the unknowns of the starts alone or by all of them.
  bool fill(const VectorXd& x, VectorXd& r, MatrixXd* jacobian) const {
    const Parameters robot = robot_at(x);
    std::vector<char> good(pieces(), 1);
    for_each_(pieces(), [&](std::size_t piece) {
      const auto found = off(robot, x, piece);
      good[piece] = found ? 1 : 0;
      if (found) r.segment(first(piece), count(piece)) = *found;
    });
    r.tail(unknowns()) = x;
    if (std::count(good.begin(), good.end(), 0) > 0) return false;
    return jacobian == nullptr || fill_slopes(x, *jacobian);
  }

  // The most likely start of a piece with these parameters, into x.
  bool fit_start(VectorXd& x, std::size_t piece) const {
    const Parameters robot = robot_at(x);
    const Index column = start_column(piece), size = count(piece);
    VectorXd at = x;
    const SlopedResiduals residuals = [&](const VectorXd& start, VectorXd& r, MatrixXd* jacobian) {
      at.segment<kStates>(column) = start;
      const auto found = off(robot, at, piece);
      if (!found) return false;
      r << *found, start;
      if (jacobian == nullptr) return true;
      jacobian->setZero();
      jacobian->bottomRows<kStates>().setIdentity();
      for (Index i = 0; i < kStates; ++i) {
        const auto by_it = slope(at, piece, column + i);
        if (!by_it) return false;
        jacobian->col(i).head(size) = *by_it;
      }
      return true;
    };
    const Fit fit = curve_fit(residuals, size + kStates, x.segment<kStates>(column));
    if (!fit.residuals.allFinite()) return false;
    x.segment<kStates>(column) = fit.value;
    return true;
  }

  bool fit_starts(VectorXd& x) const {
    std::vector<char> good(pieces(), 1);
    std::vector<VectorXd> found(pieces(), x);
    for_each_(pieces(), [&](std::size_t piece) { good[piece] = fit_start(found[piece], piece) ? 1 : 0; });
    for (std::size_t i = 0; i < pieces(); ++i) {
      x.segment<kStates>(start_column(i)) = found[i].segment<kStates>(start_column(i));
    }
    return std::count(good.begin(), good.end(), 0) == 0;
  }

  // Of the readings of a piece by one unknown, by central differences.
  std::optional<VectorXd> slope(const VectorXd& x, std::size_t piece, Index column) const {
    const double step = column < parameters() ? steps_[column] : kStepOfStart;
    VectorXd more = x, less = x;
    more[column] += step;
    less[column] -= step;
    const auto above = off(robot_at(more), more, piece), below = off(robot_at(less), less, piece);
    if (!above || !below) return std::nullopt;
    return (*above - *below) / (2 * step);
  }

 private:
  bool fill_slopes(const VectorXd& x, MatrixXd& jacobian) const {
    jacobian.setZero();
    jacobian.bottomRows(unknowns()).setIdentity();
    const Index columns = parameters() + kStates;
    const std::size_t all = pieces() * static_cast<std::size_t>(columns);
    std::vector<char> good(all, 1);
    for_each_(all, [&](std::size_t i) {
      const std::size_t piece = i / static_cast<std::size_t>(columns);
      const Index k = static_cast<Index>(i) % columns;
      const Index column = k < parameters() ? k : start_column(piece) + k - parameters();
      const auto found = slope(x, piece, column);
      good[i] = found ? 1 : 0;
      if (found) jacobian.col(column).segment(first(piece), count(piece)) = *found;
    });
    return std::count(good.begin(), good.end(), 0) == 0;
  }

  const Parameters& known_;
  const Prior& prior_;
  const std::vector<ExecutedMotion>& motions_;
  const ForEach& for_each_;
  VectorXd steps_;
  Eigen::Vector4d noise_;
  std::vector<Piece> pieces_;
  std::vector<Index> first_;
  Index readings_ = 0;
};

// Of the parameters. Readings that are off by more than counts tell less; so do neighbours that err alike: where the
// sandwich estimator with pieces' parts as clusters (Liang & Zeger, Biometrika 73, 1986) has a larger standard error,
// it is that.
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

// What cannot be less than nothing is nothing, and the others go along by the covariance.
void bound(const std::vector<std::string>& names, const Parameters& known, const MatrixXd& covariance,
           VectorXd& change) {
  Parameters p = known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!names[i].starts_with("payload.") && !names[i].starts_with("link.damping")) continue;
    const auto row = static_cast<Index>(i);
    const double below = *parameter_named(p, names[i]) + change[row];
    if (below < 0) change -= covariance.col(row) * (below / covariance(row, row));
  }
}

// By motion and encoder. [rad]
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
