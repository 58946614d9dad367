// Solves an Nlp by Ipopt (ipopt.h) or our interior-point method (interior_point.h), with the same options and report.
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
  kStopped,         // the monitor returned false
  kFailed,          // the method broke down (restoration failed, numbers not finite, ...)
};

const char* name(SolveStatus status);

// A point and its multipliers. They may be empty (size 0) with Beginning::kPoint, which does not use them.
struct Iterate {
  Eigen::VectorXd x, lambda, z_lower, z_upper;
};

enum class Optimiser {
  kIpopt,
  kInteriorPoint,  // our interior-point method (interior_point.h), and where that fails Ipopt from the same start
};

// Where a solve begins.
enum class Beginning {
  kPoint,             // at the given point, pushed off its bounds; its multipliers are estimated
  kMultipliers,       // at the given point and multipliers, which are a solution or nearly so
  kQuadraticProgram,  // from there, but at the solution of the quadratic program (quadratic_program.h), if it has one:
                      // for the solution of a neighbouring problem, whose active bounds are others. Ipopt: kMultipliers
};

enum class BarrierStrategy { kAdaptive, kMonotone };

// The name of the chain factorisation in options and requests.
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
  double final_barrier = 1e-9;   // monotone strategy only; costs about mu times the number of bounds in the objective
  Beginning beginning = Beginning::kPoint;
  BarrierStrategy barrier_strategy = BarrierStrategy::kAdaptive;
  std::string linear_solver = kChainSolver;  // one of linear_solvers(), linear_solver.h
  Optimiser optimiser = Optimiser::kIpopt;
  // Called after every iteration; return false to stop.
  std::function<bool(const IterationInfo&)> monitor;
  DoBoth both = one_after_the_other;  // runs the two halves of a factorisation, possibly on two threads
};

struct SolveReport {
  SolveStatus status = SolveStatus::kFailed;
  Iterate iterate;
  double objective = 0;
  double violation = 0;  // largest unscaled constraint violation
  double tolerance = 0;  // SolveOptions::tolerance that it was solved with
  int iterations = 0;
  // Effort of the solve, computed from counts of iterations and multiplications instead of measured, so that it is
  // reproducible. The unit is about 1 s of one core at most, and often half of that (bench/README.md).
  double work = 0;
  SolveCost cost{};
  bool fell_back = false;  // our method failed and Ipopt was used; iterations, work and cost are sums over both

  bool solved() const { return status == SolveStatus::kOptimal || status == SolveStatus::kAcceptable; }
};

// Solves nlp from `start`: n variables, m multipliers of constraints, n each of lower and upper bounds (unscaled). With
// kChainSolver several threads may call it concurrently; with MUMPS as Debian builds it, or an HSL solver, only one.
SolveReport solve(const Nlp& nlp, const Iterate& start, const SolveOptions& options);

// Returns SolveReport::work for a number of iterations and of multiplications in factorisations and their solves.
double work_of(const Nlp& nlp, int iterations, double multiplications);

}  // namespace fjr
