#include "planner/identify/readings.h"

#include <algorithm>
#include <cmath>

#include "model/identify/fit.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLongestStep = 0.25;    // largest difference step, in standard deviations of the prior
constexpr double kStepOfStart = 0.0005;  // difference step of an initial state, in units of kOffGuess

// Standard deviation of a piece's initial state from its guess [rad], [rad/s]. It is so large that the readings alone
// determine the initial state.
const State<double> kOffGuess{{0.02, 0.02}, {0.5, 0.5}, {0.02, 0.02}, {0.5, 0.5}};

// Returns difference steps of the prior's independent numbers that move no parameter by more than kSlopeStep of its
// size.
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

}  // namespace

Parameters moved(const Parameters& known, const std::vector<std::string>& names, const VectorXd& by) {
  Parameters p = known;
  for (std::size_t i = 0; i < names.size(); ++i) *parameter_named(p, names[i]) += by[static_cast<Index>(i)];
  return p;
}

Readings::Readings(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
                   const ForEach& for_each, const std::function<bool()>& stopped)
    : known_(known),
      prior_(prior),
      motions_(motions),
      for_each_(for_each),
      stopped_(stopped),
      steps_(steps_of(known, prior)),
      noise_(count_deviation(known)) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    for (const ReplayedPiece& piece : pieces_of(known, motions[i], i)) {
      pieces_.push_back(piece);
      first_.push_back(readings_);
      readings_ += count(pieces_.size() - 1);
    }
  }
}

Parameters Readings::robot_at(const VectorXd& x) const {
  return moved(known_, prior_.names, prior_.factor * x.head(parameters()));
}

// Returns simulated positions minus readings, in standard deviations of a count.
std::optional<VectorXd> Readings::off(const Parameters& robot, const VectorXd& x, std::size_t piece) const {
  if (stopped_()) return std::nullopt;
  const ReplayedPiece& at = pieces_[piece];
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

// Computes all residuals and, if `jacobian` is given, their derivatives by all unknowns.
bool Readings::fill(const VectorXd& x, VectorXd& r, MatrixXd* jacobian) const {
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

// Writes the most likely initial state of a piece, given the parameters in x, to x.
bool Readings::fit_start(VectorXd& x, std::size_t piece) const {
  const Parameters robot = robot_at(x);
  const Index column = start_column(piece), size = count(piece);
  VectorXd at = x;
  const auto evaluate = [&](const VectorXd& start, VectorXd& r, MatrixXd* jacobian) {
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
  // Ceres prints to standard error if an evaluation fails. After stopped(), zero residuals let it end quietly.
  const SlopedResiduals residuals = [&](const VectorXd& start, VectorXd& r, MatrixXd* jacobian) {
    if (evaluate(start, r, jacobian)) return true;
    if (!stopped_()) return false;
    r.setZero();
    if (jacobian != nullptr) jacobian->setZero();
    return true;
  };
  const Fit fit = curve_fit(residuals, size + kStates, x.segment<kStates>(column));
  if (stopped_() || !fit.residuals.allFinite()) return false;
  x.segment<kStates>(column) = fit.value;
  return true;
}

bool Readings::fit_starts(VectorXd& x) const {
  std::vector<char> good(pieces(), 1);
  std::vector<VectorXd> found(pieces(), x);
  for_each_(pieces(), [&](std::size_t piece) { good[piece] = fit_start(found[piece], piece) ? 1 : 0; });
  for (std::size_t i = 0; i < pieces(); ++i) {
    x.segment<kStates>(start_column(i)) = found[i].segment<kStates>(start_column(i));
  }
  return std::count(good.begin(), good.end(), 0) == 0;
}

// Returns the derivative of the residuals of a piece by one unknown, by central differences.
std::optional<VectorXd> Readings::slope(const VectorXd& x, std::size_t piece, Index column) const {
  const double step = column < parameters() ? steps_[column] : kStepOfStart;
  VectorXd more = x, less = x;
  more[column] += step;
  less[column] -= step;
  const auto above = off(robot_at(more), more, piece), below = off(robot_at(less), less, piece);
  if (!above || !below) return std::nullopt;
  return (*above - *below) / (2 * step);
}

bool Readings::fill_slopes(const VectorXd& x, MatrixXd& jacobian) const {
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

}  // namespace fjr
