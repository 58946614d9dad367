// Transfers a solution, with its multipliers, to another mesh as the initial iterate there.
//
// Costates p (costates.h) are interpolated, and the new defect multipliers solve A' lambda = -diag(b) p. The multiplier
// of a bound or a path constraint is a density in time times the quadrature weight of its point. Therefore the density
// is interpolated and multiplied with the weight on the new mesh.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "planner/collocation/costates.h"
#include "planner/collocation/transcription.h"
#include "planner/nlp/solve.h"

namespace fjr {

template <class Ocp>
class Transfer {
 public:
  using T = Transcription<Ocp>;

  Transfer(const T& from, const Iterate& old, const T& to) : from_(from), old_(old), to_(to) {}

  Iterate run() {
    result_.x = Eigen::VectorXd::Zero(to_.variables());
    result_.lambda = Eigen::VectorXd::Zero(to_.constraints());
    result_.z_lower = Eigen::VectorXd::Zero(to_.variables());
    result_.z_upper = Eigen::VectorXd::Zero(to_.variables());
    from_weight_ = weights(from_, old_.x);
    for (int s = 0; s < to_.mesh().segments(); ++s) copy_variable(from_.duration_at(s), to_.duration_at(s));
    for (int r = 0; r < T::kX; ++r) copy_variable(r, r);
    to_weight_ = weights(to_, result_.x);
    int k = 0;
    double used = 0;  // fraction of the old interval k that the new intervals have covered so far
    for (int i = 0; i < to_.intervals(); ++i) {
      const double ratio = fraction(to_, i) / fraction(from_, k);
      interval(i, k, used, std::min(1.0, used + ratio));
      used += ratio;
      if (used > 1 - 1e-9 && k + 1 < from_.intervals()) {
        ++k;
        used = 0;
      }
    }
    for (std::size_t i = 0; i < to_.ocp().duration_sums.size(); ++i) {
      result_.lambda(to_.sum_row(i)) = old_.lambda(from_.sum_row(i));
    }
    return std::move(result_);
  }

 private:
  static double fraction(const T& t, int k) { return t.mesh().intervals[static_cast<std::size_t>(k)].fraction; }

  // Quadrature weight [s] of every variable and path constraint: multiplier = density times weight.
  struct Weights {
    Eigen::VectorXd variable, row;
  };
  static Weights weights(const T& t, const Eigen::VectorXd& x) {
    Weights w{Eigen::VectorXd::Zero(t.variables()), Eigen::VectorXd::Zero(t.constraints())};
    for (int k = 0; k < t.intervals(); ++k) {
      for (int j = 0; j < t.scheme().stages(); ++j) {
        const double weight = t.step(x, k) * t.scheme().b(j);
        for (int r = 0; r < T::kX; ++r) w.variable(t.x_at(k, j) + r) += weight;
        for (int end = 0; end < 2; ++end) {
          for (int r = 0; r < T::kU; ++r)
            w.variable(t.u_at(k, end) + r) += weight * t.scheme().control_fraction(j, end);
        }
        for (int c = 0; c < T::kC; ++c) {
          if (t.path_row(k, j, c) < 0) continue;
          // A path constraint on the state alone is imposed once per node, for both intervals.
          const bool shared = !Ocp::kRowUsesControl[static_cast<std::size_t>(c)] && t.scheme().starts_at_node &&
                              j + 1 == t.scheme().stages() && k + 1 < t.intervals();
          w.row(t.path_row(k, j, c)) = weight + (shared ? t.step(x, k + 1) * t.scheme().b(0) : 0);
        }
      }
    }
    return w;
  }

  void copy_variable(int from, int to) {
    result_.x(to) = old_.x(from);
    result_.z_lower(to) = old_.z_lower(from);
    result_.z_upper(to) = old_.z_upper(from);
  }

  // Fills the new interval i, which covers the fractions [begin, end] of the old interval k.
  void interval(int i, int k, double begin, double end) {
    const auto state = from_.state_polynomial(old_.x, k);
    const auto control = from_.control_polynomial(old_.x, k);
    const Eigen::VectorXd& points = to_.scheme().points;
    for (int e = 0; e < 2; ++e) {
      const double c = e == 0 ? begin : end;
      for (int r = 0; r < T::kU; ++r) {
        const int at = to_.u_at(i, e) + r;
        result_.x(at) = control(r, 0) + c * control(r, 1);
        const auto density = [&](const Eigen::VectorXd& z) {
          return (1 - c) * z(from_.u_at(k, 0) + r) / from_weight_.variable(from_.u_at(k, 0) + r) +
                 c * z(from_.u_at(k, 1) + r) / from_weight_.variable(from_.u_at(k, 1) + r);
        };
        result_.z_lower(at) = density(old_.z_lower) * to_weight_.variable(at);
        result_.z_upper(at) = density(old_.z_upper) * to_weight_.variable(at);
      }
    }
    Eigen::MatrixXd costate(to_.scheme().stages(), T::kX);
    const Eigen::MatrixXd old_costate = costates(from_, old_.lambda, k);
    for (int j = 0; j < to_.scheme().stages(); ++j) {
      const double c = begin + points(j) * (end - begin);
      const Eigen::VectorXd hat = hat_functions(c);
      costate.row(j) = hat.transpose() * old_costate;
      if (to_.x_at(i, j) != to_.node_at(i)) stage_state(i, j, k, c, hat, state);
      for (int row = 0; row < T::kC; ++row) {
        if (to_.path_row(i, j, row) < 0) continue;
        double density = 0;
        for (int l = 0; l < from_.scheme().stages(); ++l) density += hat(l) * row_density(k, l, row);
        result_.lambda(to_.path_row(i, j, row)) = density * to_weight_.row(to_.path_row(i, j, row));
      }
    }
    defect_multipliers(i, costate);
  }

  template <class Polynomial>
  void stage_state(int i, int j, int k, double c, const Eigen::VectorXd& hat, const Polynomial& state) {
    Eigen::VectorXd value = state.col(state.cols() - 1);
    for (Eigen::Index d = state.cols() - 2; d >= 0; --d) value = value * c + state.col(d);
    for (int r = 0; r < T::kX; ++r) {
      const int at = to_.x_at(i, j) + r;
      double lower = 0, upper = 0;
      for (int l = 0; l < from_.scheme().stages(); ++l) {
        const int source = from_.x_at(k, l) + r;
        lower += hat(l) * old_.z_lower(source) / from_weight_.variable(source);
        upper += hat(l) * old_.z_upper(source) / from_weight_.variable(source);
      }
      result_.x(at) = value(r);
      result_.z_lower(at) = lower * to_weight_.variable(at);
      result_.z_upper(at) = upper * to_weight_.variable(at);
    }
  }

  double row_density(int k, int j, int c) const {
    // A path constraint on the state alone at a node belongs to the interval before it.
    if (from_.path_row(k, j, c) < 0) {
      if (k == 0 || j > 0) return 0;
      return row_density(k - 1, from_.scheme().stages() - 1, c);
    }
    return old_.lambda(from_.path_row(k, j, c)) / from_weight_.row(from_.path_row(k, j, c));
  }

  // Returns s weights for piecewise linear interpolation between the old collocation points. They are not negative, so
  // densities keep their sign.
  Eigen::VectorXd hat_functions(double c) const {
    const Eigen::VectorXd& points = from_.scheme().points;
    Eigen::VectorXd hat = Eigen::VectorXd::Zero(points.size());
    Eigen::Index right = 0;
    while (right < points.size() - 1 && points(right) < c) ++right;
    if (right == 0 || points(right) <= c) {
      hat(right) = 1;
      return hat;
    }
    const double fraction = (c - points(right - 1)) / (points(right) - points(right - 1));
    hat(right - 1) = 1 - fraction;
    hat(right) = fraction;
    return hat;
  }

  void defect_multipliers(int i, const Eigen::MatrixXd& costate) {
    const Scheme& scheme = to_.scheme();
    const int first = scheme.starts_at_node ? 1 : 0;
    const Eigen::MatrixXd system = scheme.A.bottomRows(scheme.stages() - first).transpose();
    const Eigen::MatrixXd lambda = system.colPivHouseholderQr().solve(-(scheme.b.asDiagonal() * costate));
    for (int j = first; j < scheme.stages(); ++j) {
      for (int r = 0; r < T::kX; ++r) result_.lambda(to_.defect_row(i, j, r)) = lambda(j - first, r);
    }
  }

  const T& from_;
  const Iterate& old_;
  const T& to_;
  Weights from_weight_, to_weight_;
  Iterate result_;
};

}  // namespace fjr
