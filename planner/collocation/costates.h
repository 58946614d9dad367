// Costates of the continuous problem from the multipliers of the defects.
//
// With defects y_i - y_0 - h sum_j A(i,j) f_j = 0 and multipliers lambda_i, the Lagrangian weighs f_j with
// -h sum_i A(i,j) lambda_i, which for a scheme of sufficient order is h b_j p(t_j), p the costate (Hager, Numerische
// Mathematik 87, 2000): p_j = -sum_i A(i,j) lambda_i / b_j. In this sign p = d(cost to go)/dx, and the Hamiltonian is
// running cost + p'f.
#pragma once

#include <Eigen/Core>

#include "planner/collocation/transcription.h"

namespace fjr {

// Returns the costates at the collocation points of interval k: (points x states), one point per row. lambda holds the
// multipliers of all constraints.
template <class Ocp>
Eigen::MatrixXd costates(const Transcription<Ocp>& t, const Eigen::VectorXd& lambda, int k) {
  const Scheme& scheme = t.scheme();
  const int first = scheme.starts_at_node ? 1 : 0;
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(scheme.stages(), Transcription<Ocp>::kX);
  for (int j = 0; j < scheme.stages(); ++j) {
    for (int i = first; i < scheme.stages(); ++i) {
      for (int r = 0; r < Transcription<Ocp>::kX; ++r) {
        p(j, r) -= scheme.A(i, j) * lambda(t.defect_row(k, i, r)) / scheme.b(j);
      }
    }
  }
  return p;
}

}  // namespace fjr
