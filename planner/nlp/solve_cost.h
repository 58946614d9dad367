// What a solve cost.
#pragma once

namespace fjr {

// CPU time [s] of the thread that solves, its waiting for a second one (SolveOptions::both) included, and not of that
// one. What is neither evaluation nor linear algebra is Ipopt's own.
struct SolveCost {
  double total = 0;
  double evaluation = 0;      // of the Nlp: functions and derivatives
  double linear_algebra = 0;  // assembling, factorising and solving KKT systems, without Ipopt's residuals of them
  int factorisations = 0;     // by chain/chain_ldlt.h; other linear solvers do not tell

  double ipopt() const { return total - evaluation - linear_algebra; }

  SolveCost& operator+=(const SolveCost& other) {
    total += other.total;
    evaluation += other.evaluation;
    linear_algebra += other.linear_algebra;
    factorisations += other.factorisations;
    return *this;
  }
};

}  // namespace fjr
