#include "planner/nlp/ipopt.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "common/cpu_time.h"
#include "planner/nlp/chain/ma27.h"
#include "planner/nlp/linear_solver.h"

// Up to Ipopt 3.13 the library of the linear solver is chosen by the functions of a header, later by the option hsllib.
#if __has_include(<HSLLoader.h>)
#define FJR_IPOPT_LOADER
#include <HSLLoader.h>
#endif

namespace fjr {
namespace {

using Eigen::Map;
using Eigen::VectorXd;
using Ipopt::Index;
using Ipopt::Number;

constexpr double kInfinity = 2e19;  // Ipopt takes anything beyond 1e19 as no bound

Map<const VectorXd> view(const Number* data, Index size) { return {data, size}; }
Map<VectorXd> view(Number* data, Index size) { return {data, size}; }

class Adapter final : public Ipopt::TNLP {
 public:
  Adapter(const Nlp& nlp, const Iterate& start, const SolveOptions& options)
      : nlp_(nlp), start_(start), options_(options) {}

  SolveReport report;

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = static_cast<Index>(nlp_.variables());
    m = static_cast<Index>(nlp_.constraints());
    jacobian = static_cast<Index>(nlp_.jacobian_pattern.size());
    hessian = static_cast<Index>(nlp_.hessian_pattern.size());
    style = TNLP::C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_lower, Number* x_upper, Index m, Number* g_lower, Number* g_upper) override {
    const auto bounded = [](double b) { return std::clamp(b, -kInfinity, kInfinity); };
    view(x_lower, n) = nlp_.x_lower.unaryExpr(bounded);
    view(x_upper, n) = nlp_.x_upper.unaryExpr(bounded);
    view(g_lower, m) = nlp_.g_lower.unaryExpr(bounded);
    view(g_upper, m) = nlp_.g_upper.unaryExpr(bounded);
    return true;
  }

  bool get_starting_point(Index n, bool want_x, Number* x, bool want_z, Number* z_lower, Number* z_upper, Index m,
                          bool want_lambda, Number* lambda) override {
    if (want_x) view(x, n) = start_.x;
    if (want_z) {
      if (start_.z_lower.size() != n || start_.z_upper.size() != n) return false;
      view(z_lower, n) = start_.z_lower;
      view(z_upper, n) = start_.z_upper;
    }
    if (want_lambda) {
      if (start_.lambda.size() != m) return false;
      view(lambda, m) = start_.lambda;
    }
    return true;
  }

  bool eval_f(Index n, const Number* x, bool, Number& value) override {
    const CpuTimed timed(report.cost.evaluation);
    value = nlp_.objective(view(x, n));
    return std::isfinite(value);
  }
  bool eval_grad_f(Index n, const Number* x, bool, Number* out) override {
    const CpuTimed timed(report.cost.evaluation);
    nlp_.gradient(view(x, n), view(out, n));
    return true;
  }
  bool eval_g(Index n, const Number* x, bool, Index m, Number* out) override {
    const CpuTimed timed(report.cost.evaluation);
    nlp_.constraint_values(view(x, n), view(out, m));
    return view(out, m).allFinite();
  }
  bool eval_jac_g(Index n, const Number* x, bool, Index, Index count, Index* row, Index* col, Number* out) override {
    if (out == nullptr) return copy(nlp_.jacobian_pattern, row, col);
    const CpuTimed timed(report.cost.evaluation);
    nlp_.jacobian(view(x, n), view(out, count));
    return true;
  }
  bool eval_h(Index n, const Number* x, bool, Number cost_factor, Index m, const Number* lambda, bool, Index count,
              Index* row, Index* col, Number* out) override {
    if (out == nullptr) return copy(nlp_.hessian_pattern, row, col);
    const CpuTimed timed(report.cost.evaluation);
    nlp_.hessian(view(x, n), cost_factor, view(lambda, m), view(out, count));
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number objective, Number violation, Number, Number,
                             Number, Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    report.iterations = iteration;
    report.work = work_of(nlp_, iteration, multiplications() - multiplied_before_);
    return !options_.monitor || options_.monitor({iteration, objective, violation, report.work});
  }

  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number* z_lower, const Number* z_upper,
                         Index m, const Number* g, const Number* lambda, Number objective, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    report.iterate = {view(x, n), view(lambda, m), view(z_lower, n), view(z_upper, n)};
    forget_fixed(report.iterate);
    report.objective = objective;
    const VectorXd values = view(g, m);
    report.violation = 0;
    if (m > 0) {
      report.violation = std::max({0.0, (nlp_.g_lower - values).maxCoeff(), (values - nlp_.g_upper).maxCoeff()});
    }
  }

 private:
  // From 3.14 on, Ipopt gives fixed variables the multipliers that make their gradient vanish. They have none here: on
  // a finer mesh they would be interpolated to neighbours that are not fixed.
  void forget_fixed(Iterate& iterate) const {
    for (Eigen::Index i = 0; i < iterate.x.size(); ++i) {
      if (nlp_.x_lower(i) == nlp_.x_upper(i)) iterate.z_lower(i) = iterate.z_upper(i) = 0;
    }
  }

  static bool copy(const std::vector<Nlp::Entry>& pattern, Index* row, Index* col) {
    for (const auto& entry : pattern) {
      *row++ = entry.row;
      *col++ = entry.col;
    }
    return true;
  }

  const double multiplied_before_ = multiplications();
  const Nlp& nlp_;
  const Iterate& start_;
  const SolveOptions& options_;
};

SolveStatus translate(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
    case Ipopt::Feasible_Point_Found:
      return SolveStatus::kOptimal;
    case Ipopt::Solved_To_Acceptable_Level:
      return SolveStatus::kAcceptable;
    case Ipopt::Infeasible_Problem_Detected:
      return SolveStatus::kInfeasible;
    case Ipopt::Maximum_Iterations_Exceeded:
      return SolveStatus::kIterationLimit;
    case Ipopt::User_Requested_Stop:
      return SolveStatus::kStopped;
    default:
      return SolveStatus::kFailed;
  }
}

// Sets options by name. An option that Ipopt refuses is a bug here, so it throws std::logic_error.
class Options {
 public:
  explicit Options(Ipopt::IpoptApplication& application)
      : list_(*application.Options()), known_(*application.RegOptions()) {}
  bool has(const char* name) const { return Ipopt::IsValid(known_.GetOption(name)); }
  void SetNumericValue(const char* name, double value) { check(list_.SetNumericValue(name, value), name); }
  void SetIntegerValue(const char* name, Index value) { check(list_.SetIntegerValue(name, value), name); }
  void SetStringValue(const char* name, const std::string& value) { check(list_.SetStringValue(name, value), name); }

 private:
  static void check(bool accepted, const char* name) {
    if (!accepted) throw std::logic_error(std::string("Ipopt refuses the option ") + name);
  }
  Ipopt::OptionsList& list_;
  Ipopt::RegisteredOptions& known_;
};

void configure(Options o, const SolveOptions& options, const std::string& linear_solver) {
  const bool monotone = options.barrier_strategy == BarrierStrategy::kMonotone;
  o.SetNumericValue("tol", options.tolerance);
  o.SetNumericValue("constr_viol_tol", options.constraint_tolerance);
  o.SetNumericValue("acceptable_constr_viol_tol", 10 * options.constraint_tolerance);  // Ipopt's own default is 1e-2
  o.SetIntegerValue("max_iter", options.max_iterations);
  o.SetStringValue("linear_solver", linear_solver == kChainSolver ? "ma27" : linear_solver);
  o.SetStringValue("linear_system_scaling", "none");
  // Refine the solution of the linear system only if its residual is too large (residual_ratio_max). Ipopt's default
  // always refines once. The iterations are the same up to rounding, and a whole plan takes 5 % fewer instructions.
  o.SetIntegerValue("min_refinement_steps", 0);
  o.SetStringValue("mu_strategy", monotone ? "monotone" : "adaptive");
  o.SetNumericValue("mu_init", options.initial_barrier);
  // Ipopt stops lowering mu at min(tol, compl_inf_tol) / (barrier_tol_factor + 1).
  if (monotone) o.SetNumericValue("compl_inf_tol", 11 * options.final_barrier);
  o.SetIntegerValue("print_level", 0);
  if (o.has("timing_statistics")) o.SetStringValue("timing_statistics", "yes");  // from 3.14 on, not by itself
  o.SetStringValue("sb", "yes");
  o.SetStringValue("fixed_variable_treatment", "make_parameter");
  o.SetNumericValue("bound_relax_factor", 0);  // a limit is a limit; the certificate checks it to 1e-6
  if (options.beginning != Beginning::kPoint) {
    o.SetStringValue("warm_start_init_point", "yes");
    o.SetNumericValue("warm_start_bound_push", 1e-9);
    o.SetNumericValue("warm_start_bound_frac", 1e-9);
    o.SetNumericValue("warm_start_slack_bound_push", 1e-9);
    o.SetNumericValue("warm_start_slack_bound_frac", 1e-9);
    o.SetNumericValue("warm_start_mult_bound_push", 1e-9);
  } else if (options.initial_barrier < 0.05) {  // a good primal guess: do not push it far off its bounds
    o.SetNumericValue("bound_push", 1e-4);
    o.SetNumericValue("bound_frac", 1e-4);
    o.SetNumericValue("slack_bound_push", 1e-4);
    o.SetNumericValue("slack_bound_frac", 1e-4);
    o.SetStringValue("bound_mult_init_method", "mu-based");
  }
}

// Returns the structure of Ipopt's KKT matrix, whose rows are: free variables (fixed ones are parameters), slacks,
// equalities, inequalities.
ChainStructure kkt_structure(const Nlp& nlp) {
  ChainStructure kkt{nlp.blocks, {}, {}};
  std::vector<int> equalities, inequalities;
  for (Index i = 0; i < nlp.variables(); ++i) {
    if (nlp.x_lower(i) != nlp.x_upper(i)) kkt.block.push_back(nlp.variable_block[static_cast<std::size_t>(i)]);
  }
  for (Index i = 0; i < nlp.constraints(); ++i) {
    (nlp.g_lower(i) == nlp.g_upper(i) ? equalities : inequalities)
        .push_back(nlp.constraint_block[static_cast<std::size_t>(i)]);
  }
  kkt.equality.assign(kkt.block.size(), false);
  for (const auto* part : {&inequalities, &equalities, &inequalities}) {
    kkt.block.insert(kkt.block.end(), part->begin(), part->end());
    kkt.equality.resize(kkt.block.size(), part == &equalities);
  }
  return kkt;
}

// Makes Ipopt load the routines of the linear solver from its library. Throws std::runtime_error if that fails.
void load([[maybe_unused]] Ipopt::IpoptApplication& application, const std::string& linear_solver) {
  const std::string library = library_of(linear_solver);
  if (library.empty()) return;
#ifdef FJR_IPOPT_LOADER
  static std::mutex one_at_a_time;
  static std::string loaded;
  const std::lock_guard lock(one_at_a_time);
  if (loaded == library) return;
  if (LSL_isHSLLoaded() != 0) LSL_unloadHSL();
  loaded.clear();
  std::array<char, 512> message{};
  if (LSL_loadHSL(library.c_str(), message.data(), static_cast<int>(message.size())) != 0) {
    throw std::runtime_error("Ipopt cannot load " + library + ": " + message.data());
  }
  loaded = library;
#else
  Options(application).SetStringValue("hsllib", library);
#endif
}

// Returns the time [s] Ipopt spent on assembling, factorising and solving KKT systems. Ipopt measures the CPU time of
// the process; that suffices here, because only the chain factorisation runs in several threads, and it has its own
// clock. Ipopt's more detailed times are not used, because with MUMPS they leave out the solves.
double linear_algebra(Ipopt::IpoptApplication& application) {
  const Ipopt::TimedTask& task = application.IpoptDataObject()->TimingStats().StdAugSystemSolverMultiSolve();
  return task.TotalCpuTime() + task.TotalSysTime();
}

}  // namespace

SolveReport solve_by_ipopt(const Nlp& nlp, const Iterate& start, const SolveOptions& options) {
  const double began = cpu_time();
  const int factorised = factorisations();
  const double chain_before = chain_seconds();
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  // The chain factorisation needs the blocks of the problem; without them MUMPS is used.
  const std::string linear_solver = nlp.blocks == 0 ? "mumps" : options.linear_solver;
  if (linear_solver == kChainSolver) describe_chain(kkt_structure(nlp), options.both);
  configure(Options(*application), options, linear_solver);
  load(*application, linear_solver);
  application->Initialize("");                          // no options file: a plan depends on its request alone
  Adapter* adapter = new Adapter(nlp, start, options);  // owned by the smart pointer, Ipopt's own reference count
  Ipopt::SmartPtr<Ipopt::TNLP> held = adapter;
  const auto status = application->OptimizeTNLP(held);
  if (linear_solver == kChainSolver) describe_chain({}, one_after_the_other);
  adapter->report.status = translate(status);
  SolveCost& cost = adapter->report.cost;
  cost.linear_algebra = linear_solver == kChainSolver ? chain_seconds() - chain_before : linear_algebra(*application);
  cost.factorisations = factorisations() - factorised;
  cost.total = cpu_since(began);
  return adapter->report;
}

}  // namespace fjr
