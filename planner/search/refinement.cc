#include "planner/search/refinement.h"

#include <algorithm>
#include <cmath>

#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

using Vector8 = Eigen::Matrix<double, kStates, 1>;

Vector8 rate(const Parameters& robot, const Motion& motion, std::size_t k, double time, const Vector8& x) {
  const auto f = compensated_dynamics(robot, State<double>::from(x.data()), motion.torque_in(k, time));
  Vector8 derivative;
  f.copy_to(derivative.data());
  return derivative;
}

// Classical Runge-Kutta over interval k. Substeps short enough that its own error is far below a collocation step's.
State<double> integrate_interval(const Parameters& robot, const Motion& motion, std::size_t k) {
  constexpr int kSubsteps = 8;
  const auto& interval = motion.intervals[k];
  const double h = interval.duration / kSubsteps;
  Vector8 x = interval.state.col(0);
  for (int i = 0; i < kSubsteps; ++i) {
    const double t = interval.start + i * h;
    const Vector8 k1 = rate(robot, motion, k, t, x);
    const Vector8 k2 = rate(robot, motion, k, t + h / 2, x + h / 2 * k1);
    const Vector8 k3 = rate(robot, motion, k, t + h / 2, x + h / 2 * k2);
    const Vector8 k4 = rate(robot, motion, k, t + h, x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return State<double>::from(x.data());
}

}  // namespace

double error_size(const State<double>& difference) {
  double size = 0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    size = std::max({size, std::abs(difference.q[j]), std::abs(difference.theta[j]),
                     kErrorTime * std::abs(difference.dq[j]), kErrorTime * std::abs(difference.dtheta[j])});
  }
  return size;
}

std::vector<double> interval_errors(const Parameters& robot, const Motion& motion) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    State<double> difference = integrate_interval(robot, motion, k);
    const auto& interval = motion.intervals[k];
    const State<double> planned = motion.state_in(k, interval.start + interval.duration);
    for (int i = 0; i < kStates; ++i) difference[i] -= planned[i];
    errors.push_back(error_size(difference));
  }
  return errors;
}

std::vector<double> cost_errors(const Problem& problem, const Joints<FrictionLaw>& friction, const Scheme& scheme,
                                const Motion& motion) {
  constexpr int kPieces = 32;  // midpoint rule: fine enough to tell whether the scheme's few points are
  const Parameters& robot = problem.robot;
  std::vector<double> errors;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const auto& interval = motion.intervals[k];
    const auto cost = [&](double c) {
      const double time = interval.start + c * interval.duration;
      const State<double> x = motion.state_in(k, time);
      Joints<double> torque = motion.torque_in(k, time);
      for (std::size_t j = 0; j < kJoints; ++j) torque[j] += friction[j].nonlinear(x.dtheta[j]);
      const Joints<double> ddq = link_acceleration(robot, x.q, x.dq, spring_torque(robot, x.q, x.theta));
      return running_cost(problem.weights, Instant<double>{robot, x, ddq, torque});
    };
    double difference = 0;
    for (int j = 0; j < scheme.stages(); ++j) difference += scheme.b(j) * cost(scheme.points(j));
    for (int i = 0; i < kPieces; ++i) difference -= cost((i + 0.5) / kPieces) / kPieces;
    errors.push_back(std::abs(difference) * interval.duration);
  }
  return errors;
}

std::vector<int> pieces_wanted(const Motion& motion, const std::vector<double>& errors, double tolerance, int order,
                               double shortest) {
  std::vector<int> pieces;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    int wanted = 1;
    if (errors[k] > tolerance) wanted = errors[k] > std::pow(2.0, order + 1) * tolerance ? 4 : 2;
    while (wanted > 1 && motion.intervals[k].duration / wanted < shortest) wanted /= 2;
    pieces.push_back(wanted);
  }
  return pieces;
}

Mesh split(const Mesh& mesh, const std::vector<int>& pieces) { return split(mesh, equal_cuts(pieces)); }

Mesh split(const Mesh& mesh, const Cuts& cuts) {
  Mesh finer;
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    const auto& interval = mesh.intervals[k];
    double from = 0;
    for (const double cut : cuts[k]) {
      finer.intervals.push_back({interval.fraction * (cut - from), interval.segment});
      from = cut;
    }
    finer.intervals.push_back({interval.fraction * (1 - from), interval.segment});
  }
  return finer;
}

Cuts equal_cuts(const std::vector<int>& pieces) {
  Cuts cuts(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (int i = 1; i < pieces[k]; ++i) cuts[k].push_back(static_cast<double>(i) / pieces[k]);
  }
  return cuts;
}

std::optional<double> reversal_in(const Motion& motion, std::size_t k, std::size_t joint) {
  constexpr int kProbes = 16, kBisections = 30;
  const auto& interval = motion.intervals[k];
  const auto velocity = [&](double fraction) {
    return motion.state_in(k, interval.start + fraction * interval.duration).dtheta[joint];
  };
  for (int i = 0; i < kProbes; ++i) {
    double from = static_cast<double>(i) / kProbes, to = static_cast<double>(i + 1) / kProbes;
    const double before = velocity(from);
    if (!(before * velocity(to) < 0)) continue;
    for (int b = 0; b < kBisections; ++b) {
      const double middle = 0.5 * (from + to);
      (before * velocity(middle) < 0 ? to : from) = middle;
    }
    return 0.5 * (from + to);
  }
  return {};
}

void cut_around(std::vector<double>& cuts, double fraction, double shortest) {
  // Fraction of the interval. The reversal moves with the next solution; if cuts are closer, it has to be cut around
  // again.
  constexpr double kApart = 0.05;
  if (shortest > 0.7) return;
  const double half = 0.5 * std::max(kApart, shortest), from = fraction - half, to = fraction + half;
  const double near = 0.4 * shortest;
  std::erase_if(cuts, [&](double cut) { return cut > from - near && cut < to + near; });
  for (const double cut : {from, to}) {
    if (cut > near && cut < 1 - near) cuts.push_back(cut);
  }
  std::sort(cuts.begin(), cuts.end());
}

}  // namespace fjr
