// Computes from the multipliers of a solution the derivatives of the optimal objective and the Hamiltonian.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "planner/collocation/costates.h"
#include "planner/collocation/sampled_limits.h"
#include "planner/collocation/transcription.h"
#include "planner/nlp/solve.h"

namespace fjr {

struct Adjoint {
  // Gradient of objective + lambda' constraints with respect to the variables, without the multipliers of their bounds.
  // For a variable fixed by its bounds, the entry is the derivative of the optimal objective by the fixed value.
  Eigen::VectorXd lagrangian;
  // The same sum with only the defect constraints. The entry of a control is dH/du integrated over the collocation
  // points that depend on this variable.
  Eigen::VectorXd hamiltonian_gradient;
  Eigen::VectorXd control_weight;   // [s] per variable: integral over time of du/d(variable); 0 if it is no control
  std::vector<double> hamiltonian;  // see hamiltonians()
  std::vector<double> conserved;    // see conserved()
  std::vector<double> node_times;   // [s]
};

namespace adjoint_detail {

template <class Ocp>
std::vector<char> defect_rows(const Transcription<Ocp>& t) {
  std::vector<char> defect(static_cast<std::size_t>(t.constraints()), 0);
  for (int k = 0; k < t.intervals(); ++k) {
    for (int i = t.scheme().starts_at_node ? 1 : 0; i < t.scheme().stages(); ++i) {
      for (int r = 0; r < Ocp::kStates; ++r) defect[static_cast<std::size_t>(t.defect_row(k, i, r))] = 1;
    }
  }
  return defect;
}

// Returns sum_j b_j H_j over the collocation points j of interval k.
template <class Ocp>
double mean_hamiltonian(const Transcription<Ocp>& t, const Iterate& solution, int k) {
  const Scheme& scheme = t.scheme();
  const Eigen::MatrixXd p = costates(t, solution.lambda, k);
  double mean = 0;
  for (int j = 0; j < scheme.stages(); ++j) {
    const auto at = t.values(solution.x, k, j);
    const Eigen::Map<const Eigen::Matrix<double, Ocp::kStates, 1>> f(at.f.data());
    mean += scheme.b(j) * (at.cost + p.row(j).dot(f));
  }
  return mean;
}

}  // namespace adjoint_detail

// Returns the mean of H over each interval, which is the derivative of the Lagrangian by the duration of that interval.
template <class Ocp>
std::vector<double> hamiltonians(const Transcription<Ocp>& t, const Iterate& solution) {
  std::vector<double> all;
  for (int k = 0; k < t.intervals(); ++k) all.push_back(adjoint_detail::mean_hamiltonian(t, solution, k));
  return all;
}

// Returns the Hamiltonian per interval without those jumps at nodes that arise because limits are imposed at points
// that move with the nodes (sampled_limits.h). The result is determined up to a constant. At an optimum it is constant
// between via points.
template <class Ocp>
std::vector<double> conserved(const Transcription<Ocp>& t, const Iterate& solution,
                              const std::vector<double>& hamiltonian) {
  const std::vector<SampledLimits> limits = sampled_limits(t, solution);
  std::vector<double> all{hamiltonian.front()};
  for (std::size_t k = 1; k < hamiltonian.size(); ++k) {
    all.push_back(all.back() - limits[k].left_of(hamiltonian[k - 1] - hamiltonian[k]));
  }
  return all;
}

// Evaluates the first derivatives once; `solution` needs multipliers of all constraints.
template <class Ocp>
Adjoint adjoint(const Transcription<Ocp>& t, const Iterate& solution) {
  Adjoint a;
  a.hamiltonian_gradient.resize(t.variables());
  t.gradient(solution.x, a.hamiltonian_gradient);
  a.lagrangian = a.hamiltonian_gradient;
  Eigen::VectorXd jacobian(static_cast<Eigen::Index>(t.jacobian_pattern.size()));
  t.jacobian(solution.x, jacobian);
  const std::vector<char> defect = adjoint_detail::defect_rows(t);
  for (std::size_t e = 0; e < t.jacobian_pattern.size(); ++e) {
    const auto [row, col] = t.jacobian_pattern[e];
    const double term = solution.lambda(row) * jacobian(static_cast<Eigen::Index>(e));
    a.lagrangian(col) += term;
    if (defect[static_cast<std::size_t>(row)]) a.hamiltonian_gradient(col) += term;
  }
  a.control_weight = Eigen::VectorXd::Zero(t.variables());
  const Eigen::RowVectorXd fraction = t.scheme().b.transpose() * t.scheme().control_fraction;
  for (int k = 0; k < t.intervals(); ++k) {
    const double h = t.step(solution.x, k);
    for (int end = 0; end < 2; ++end)
      a.control_weight.segment(t.u_at(k, end), Ocp::kControls).array() = h * fraction(end);
  }
  a.hamiltonian = hamiltonians(t, solution);
  a.conserved = conserved(t, solution, a.hamiltonian);
  a.node_times = t.mesh().node_times(t.durations(solution.x));
  return a;
}

}  // namespace fjr
