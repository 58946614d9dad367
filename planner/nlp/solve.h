// Who optimises an Nlp, and how: what Ipopt (ipopt.h) and our interior-point method (interior_point.h) have in common.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "planner/nlp/nlp.h"
#include "planner/nlp/solve_cost.h"

namespace fjr {

enum class SolveStatus {
  kOptimal,         // converged to `tolerance`
  kAcceptable,      // stopped at the looser acceptable tolerance: usable, less exact
  kInfeasible,      // converged to a point of local infeasibility
  kIterationLimit,  // `max_iterations` reached
  kStopped,         // the monitor said stop
  kFailed,          // the method broke down (restoration failed, numbers not finite, ...)
};

const char* name(SolveStatus status);

// A point and its multipliers; multipliers may be empty (size 0): then they are estimated.
struct Iterate {
  Eigen::VectorXd x, lambda, z_lower, z_upper;
};

enum class Optimiser {
  kIpopt,
  kOwn,  // our interior-point method (interior_point.h), and where that fails Ipopt from the same start
};

enum class BarrierStrategy { kAdaptive, kMonotone };

// The name of our linear solver, the chain factorisation, as it is asked for.
inline constexpr const char* kChainSolver = "stage";

struct IterationInfo {
  int iteration;
  double objective, violation;
  double work;  // SolveReport::work so far
};

struct SolveOptions {
  double tolerance = 1e-6;
  double constraint_tolerance = 1e-9;  // absolute, unscaled
  int max_iterations = 500;
  double initial_barrier = 0.1;  // mu; small for warm starts
  double final_barrier = 1e-9;   // with the monotone strategy; the objective is worse by about mu times the bounds
  bool warm_start = false;       // start from the given multipliers and do not push the point off its bounds
  BarrierStrategy barrier_strategy = BarrierStrategy::kAdaptive;
  std::string linear_solver = kChainSolver;  // one of linear_solvers(), linear_solver.h
  Optimiser optimiser = Optimiser::kIpopt;
  int print_level = 0;
  // Called after every iteration; return false to stop.
  std::function<bool(const IterationInfo&)> monitor;
  DoBoth both = one_after_the_other;     // how the halves of a factorisation are worked off
  Eigen::VectorXd x_scaling, g_scaling;  // empty: Ipopt's gradient-based scaling
  double objective_scaling = 1;
};

struct SolveReport {
  SolveStatus status = SolveStatus::kFailed;
  Iterate iterate;
  double objective = 0;
  double violation = 0;  // largest unscaled constraint violation
  double tolerance = 0;  // SolveOptions::tolerance that it was solved with
  int iterations = 0;
  // What the solve took, counted in the optimiser's steps and not in time, so that it is the same every time: about
  // seconds of one core of the machine that the weights were measured on (bench/README.md).
  double work = 0;
  SolveCost cost{};
  bool fell_back = false;  // our method had failed, and Ipopt was asked; the costs are of both

  bool solved() const { return status == SolveStatus::kOptimal || status == SolveStatus::kAcceptable; }
};

// start: n variables, m multipliers of constraints, n of lower and of upper bounds, as nlp has them. With kChainSolver
// it may be called by several threads at a time; with MUMPS, as Debian builds it, and with the HSL's by one.
SolveReport solve(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

// Work of so many iterations, with so many multiplications in factorisations and their solves (SolveReport::work).
double work_of(const Nlp& nlp, int iterations, double multiplications);

}  // namespace fjr
