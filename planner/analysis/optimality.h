// Pontryagin's conditions along a solution.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/analysis/analysis.h"
#include "planner/collocation/adjoint.h"

namespace fjr {

// A bound counts as active if the value is within this fraction of it. For a bound of 0 the fraction is of the largest
// term in the sum that it bounds.
inline constexpr double kActive = 0.01;

// Returns the spread of H up to which a solution counts as stationary. At an optimum H is constant; on a mesh a small
// spread remains. Up to this fraction of objective / duration, d objective / d duration agrees with the objectives of
// slightly longer and shorter plans (ShadowPriceOfTheDurationIsTheSlopeOfTheObjective in
// tests/planner/effort_plan_test.cc).
inline double allowed_spread(double objective, double duration) {
  constexpr double kFraction = 0.02;
  return kFraction * std::abs(objective) / duration;
}

// Returns the mean of one value per interval over the intervals first, ..., last - 1, weighted by their durations.
inline double mean_over(const Adjoint& a, const std::vector<double>& values, std::size_t first, std::size_t last) {
  double integral = 0;
  for (std::size_t k = first; k < last; ++k) integral += values[k] * (a.node_times[k + 1] - a.node_times[k]);
  return integral / (a.node_times[last] - a.node_times[first]);
}

// Returns the mean of H over these intervals.
inline double mean_hamiltonian(const Adjoint& a, std::size_t first, std::size_t last) {
  return mean_over(a, a.hamiltonian, first, last);
}

// Returns the integral over a segment of the squared deviation from the segment's mean.
inline double variation(const Adjoint& a, const std::vector<double>& values, std::size_t first, std::size_t last) {
  const double mean = mean_over(a, values, first, last);
  double squares = 0;
  for (std::size_t k = first; k < last; ++k) {
    squares += (values[k] - mean) * (values[k] - mean) * (a.node_times[k + 1] - a.node_times[k]);
  }
  return squares;
}

// Returns, for each segment, either H or H without the jumps that limits explain (shifted to the same mean), whichever
// varies less. If H is constant, no node would improve the objective at another time. If it is constant only without
// these jumps, nodes would move only because limits are imposed at points that move with them.
inline std::vector<double> conserved_along(const Adjoint& a, const std::vector<std::size_t>& begins) {
  std::vector<double> along = a.hamiltonian;
  for (std::size_t segment = 0; segment + 1 < begins.size(); ++segment) {
    const std::size_t first = begins[segment], last = begins[segment + 1];
    if (variation(a, a.conserved, first, last) >= variation(a, a.hamiltonian, first, last)) continue;
    const double shift = mean_hamiltonian(a, first, last) - mean_over(a, a.conserved, first, last);
    for (std::size_t k = first; k < last; ++k) along[k] = a.conserved[k] + shift;
  }
  return along;
}

// Computes the statistics of H. begins: the first interval of each segment, within which H should be constant, and then
// the number of intervals; {0, n} without via points.
inline Optimality::Hamiltonian hamiltonian(const Adjoint& a, const std::vector<std::size_t>& begins) {
  Optimality::Hamiltonian result;
  result.mean = mean_hamiltonian(a, 0, a.hamiltonian.size());
  double squares = 0;
  const std::vector<double> along = conserved_along(a, begins);
  for (std::size_t segment = 0; segment + 1 < begins.size(); ++segment) {
    const double mean = mean_hamiltonian(a, begins[segment], begins[segment + 1]);
    for (std::size_t k = begins[segment]; k < begins[segment + 1]; ++k) {
      const double deviation = std::abs(along[k] - mean);
      squares += deviation * deviation * (a.node_times[k + 1] - a.node_times[k]);
      if (deviation <= result.largest) continue;
      result.largest = deviation;
      result.time = (a.node_times[k] + a.node_times[k + 1]) / 2;
    }
  }
  result.spread = std::sqrt(squares / a.node_times.back());
  return result;
}

// Returns per variable the directions that active limits block: bit 1 up, bit 2 down.
template <class Ocp>
std::vector<int> held(const Transcription<Ocp>& t, const Iterate& solution) {
  std::vector<int> held(static_cast<std::size_t>(t.variables()), 0);
  const auto side = [](double value, double lower, double upper, double largest = 0) {
    const auto near = [&](double bound, double gap) {
      return std::isfinite(bound) && gap <= kActive * (bound == 0 ? largest : std::abs(bound));
    };
    return (near(upper, upper - value) ? 1 : 0) | (near(lower, value - lower) ? 2 : 0);
  };
  for (Eigen::Index i = 0; i < t.variables(); ++i) {
    held[static_cast<std::size_t>(i)] = side(solution.x(i), t.x_lower(i), t.x_upper(i));
  }
  Eigen::VectorXd values(t.constraints());
  t.constraint_values(solution.x, values);
  Eigen::VectorXd jacobian(static_cast<Eigen::Index>(t.jacobian_pattern.size()));
  t.jacobian(solution.x, jacobian);
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(t.constraints());
  for (std::size_t e = 0; e < t.jacobian_pattern.size(); ++e) {
    const auto [row, col] = t.jacobian_pattern[e];
    largest(row) = std::max(largest(row), std::abs(jacobian(static_cast<Eigen::Index>(e)) * solution.x(col)));
  }
  for (std::size_t e = 0; e < t.jacobian_pattern.size(); ++e) {
    const auto [row, col] = t.jacobian_pattern[e];
    const double slope = jacobian(static_cast<Eigen::Index>(e));
    if (slope == 0 || t.g_lower(row) == t.g_upper(row)) continue;
    const int by = side(values(row), t.g_lower(row), t.g_upper(row), largest(row));
    const bool swap = slope < 0 && (by == 1 || by == 2);
    held[static_cast<std::size_t>(col)] |= swap ? 3 - by : by;
  }
  return held;
}

template <class Ocp>
Optimality::Stationarity stationarity(const Transcription<Ocp>& t, const Iterate& solution, const Adjoint& a) {
  Optimality::Stationarity result;
  const std::vector<int> sides = held(t, solution);
  double squares = 0, time = 0;
  for (Eigen::Index i = 0; i < t.variables(); ++i) {
    if (a.control_weight(i) <= 0) continue;
    const double slope = a.hamiltonian_gradient(i) / a.control_weight(i);
    const double left = (a.lagrangian(i) - solution.z_lower(i) + solution.z_upper(i)) / a.control_weight(i);
    result.largest = std::max(result.largest, std::abs(slope));
    result.residual = std::max(result.residual, std::abs(left));
    const int side = sides[static_cast<std::size_t>(i)];
    if (side == 0) {
      squares += slope * slope * a.control_weight(i);
      time += a.control_weight(i);
    }
    if (side == 1) result.wrong = std::max(result.wrong, slope);  // H would rise upwards: it should have moved down
    if (side == 2) result.wrong = std::max(result.wrong, -slope);
  }
  if (time > 0) result.free = std::sqrt(squares / time);
  return result;
}

}  // namespace fjr
