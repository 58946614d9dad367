#include "planner/nlp/solve.h"

#include "planner/nlp/interior_point.h"
#include "planner/nlp/ipopt.h"

namespace fjr {
namespace {

// Returns whether Ipopt should try again, because it has a restoration phase and our method does not. After an
// iteration limit it should not.
bool broke_down(SolveStatus status) { return status == SolveStatus::kFailed; }

}  // namespace

const char* name(SolveStatus status) {
  switch (status) {
    case SolveStatus::kOptimal:
      return "optimal";
    case SolveStatus::kAcceptable:
      return "acceptable";
    case SolveStatus::kInfeasible:
      return "infeasible";
    case SolveStatus::kIterationLimit:
      return "iteration_limit";
    case SolveStatus::kStopped:
      return "stopped";
    case SolveStatus::kFailed:
      return "failed";
  }
  return "unknown";
}

namespace {

// Uses our interior-point method if the options ask for it and for the chain factorisation; otherwise, or where it
// breaks down, Ipopt.
SolveReport solve_by_either(const Nlp& nlp, const Iterate& start, const SolveOptions& options) {
  const bool own = options.optimiser == Optimiser::kInteriorPoint && options.linear_solver == kChainSolver;
  if (!own) return solve_by_ipopt(nlp, start, options);
  SolveReport first = solve_by_interior_point(nlp, start, options);
  if (!broke_down(first.status)) return first;
  SolveOptions rest = options;
  if (options.monitor) {
    rest.monitor = [&](IterationInfo info) {
      info.iteration += first.iterations;
      info.work += first.work;
      return options.monitor(info);
    };
  }
  SolveReport second = solve_by_ipopt(nlp, start, rest);
  second.iterations += first.iterations;
  second.work += first.work;
  second.cost += first.cost;
  second.fell_back = true;
  return second;
}

}  // namespace

SolveReport solve(const Nlp& nlp, const Iterate& start, const SolveOptions& options) {
  SolveReport report = solve_by_either(nlp, start, options);
  report.tolerance = options.tolerance;
  return report;
}

// Apart from the factorisations, the work of an iteration is proportional to the numbers of derivatives, variables and
// constraints.
double work_of(const Nlp& nlp, int iterations, double multiplications) {
  constexpr double kPerEntry = 2e-8;  // [s] per iteration and derivative, variable or constraint
  // [s] for the second derivatives of one constraint. They are counted per constraint, because those of many task
  // constraints contribute to the same few Hessian entries.
  constexpr double kPerConstraint = 4e-7;
  constexpr double kPerMultiplication = 6.5e-10;  // [s]
  const auto entries = nlp.jacobian_pattern.size() + nlp.hessian_pattern.size() +
                       static_cast<std::size_t>(nlp.variables() + nlp.constraints());
  const double each =
      kPerEntry * static_cast<double>(entries) + kPerConstraint * static_cast<double>(nlp.constraints());
  return each * iterations + kPerMultiplication * multiplications;
}

}  // namespace fjr
