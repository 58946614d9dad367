// CPU time of a solve by its parts.
#pragma once

namespace fjr {

// CPU time [s] of the solving thread. It includes waiting for a second thread (SolveOptions::both), but not the time of
// that thread. What is neither evaluation nor linear algebra is spent in the optimiser itself, which plan.json calls
// `ipopt`, whichever it is.
struct SolveCost {
  double total = 0;
  double evaluation = 0;      // functions and derivatives of the Nlp
  double linear_algebra = 0;  // assembling, factorising and solving KKT systems, without Ipopt's residuals
  int factorisations = 0;     // by chain/chain_ldlt.h; unknown (0) with other linear solvers

  double in_optimiser() const { return total - evaluation - linear_algebra; }

  SolveCost& operator+=(const SolveCost& other) {
    total += other.total;
    evaluation += other.evaluation;
    linear_algebra += other.linear_algebra;
    factorisations += other.factorisations;
    return *this;
  }
};

}  // namespace fjr
