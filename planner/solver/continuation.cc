#include "planner/solver/continuation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/collocation/creep.h"
#include "planner/collocation/margins.h"
#include "planner/collocation/refinement.h"
#include "planner/trajectory/objective.h"

namespace fjr {
namespace {

// Widths of the smoothed friction law [rad/s], each solution starting the next; 0 is the exact law. Effort lives in the
// friction's step, where a motor parks: steps of about three keep every warm start within tens of iterations. Without
// effort the law only moves a torque limit, and large steps do.
const std::vector<double>& friction_widths(const Problem& problem) {
  static const std::vector<double> fine{0.1, 0.03, 0.01, 0.003, 0.001, 0.0003, 0};
  static const std::vector<double> coarse{0.1, 0.01, 0};
  return problem.weights.effort > 0 ? fine : coarse;
}

constexpr double kExcessWorthSplitting = 0.02;  // share of a limit beyond which a margin would cost more than intervals
constexpr double kEffortTolerance = 3e-5;       // share of the objective by which an interval may misjudge the effort
constexpr int kMeshRounds = 5;
constexpr int kMarginRounds = 8;
constexpr int kCreepRounds = 3;

// Short enough for the first solution to have the right shape: the springs swing at up to 50 rad/s.
int coarse_intervals(const Problem& problem, double duration) {
  constexpr double kCoarseStep = 0.02;  // [s]
  return std::clamp(static_cast<int>(std::ceil(duration / kCoarseStep)), 25, 400) +
         2 * static_cast<int>(problem.via.size());
}

}  // namespace

Continuation::Continuation(const Problem& problem, ContinuationSettings settings, Interrupted interrupted,
                           std::function<void(const Progress&)> on_progress)
    : problem_(&problem),
      settings_(std::move(settings)),
      interrupted_(std::move(interrupted)),
      on_progress_(std::move(on_progress)) {}

SolveOptions Continuation::options(const std::string& what) {
  SolveOptions o;
  o.linear_solver = settings_.linear_solver;
  o.max_iterations = settings_.warm_iterations;
  o.monitor = [this, what](const IterationInfo& info) {
    if (on_progress_) on_progress_({what, iterations_ + info.iteration, info.objective, info.violation});
    return !interrupted_();
  };
  return o;
}

// A warm start (no guess) begins from the present solution and its multipliers, on the same mesh.
bool Continuation::attempt(const std::string& what, const CollocationSetup& setup, const Guess* guess,
                           const SolveOptions& solve_options) {
  if (interrupted_()) {
    status_ = SolveStatus::kStopped;
    return false;
  }
  Collocated next = guess != nullptr ? collocate(*problem_, setup, *guess, solve_options)
                                     : collocate(*problem_, setup, solution_, solve_options);
  iterations_ += next.report.iterations;
  status_ = next.report.status;
  stages_.push_back({what, static_cast<int>(setup.mesh.size()), next.report.iterations, next.report.objective,
                     name(next.report.status)});
  if (!next.report.solved()) {
    if (!next.motion.intervals.empty()) obstacle_ = worst_excess(*problem_, next.motion);
    return false;
  }
  solution_ = std::move(next);
  return true;
}

bool Continuation::cold(const Guess& guess) {
  const std::string what = fmt::format("{}, {}", label, guess.name);
  SolveOptions o = options(what);
  o.max_iterations = settings_.cold_iterations;
  const CollocationSetup setup{settings_.scheme,
                               uniform_mesh(*problem_, coarse_intervals(*problem_, guess.duration)),
                               friction_widths(*problem_).front(),
                               {}};
  return attempt(what, setup, &guess, o);
}

// Each law's solution starts the next. The one that would be published for the least, with the exact law, is kept: a
// sharper law usually helps, but now and then a step slips into a worse minimum or fails.
bool Continuation::follow_friction() {
  Collocated best = solution_;
  double least = published_objective(*problem_, best.motion);
  for (const double width : friction_widths(*problem_)) {
    if (width >= solution_.setup.friction_width) continue;
    const std::string what = fmt::format("{}, friction width {} rad/s", label, width);
    SolveOptions o = options(what);
    o.warm_start = true;
    o.initial_barrier = 1e-5;
    CollocationSetup setup = solution_.setup;
    setup.friction_width = width;
    if (!attempt(what, setup, nullptr, o)) break;
    const double objective = published_objective(*problem_, solution_.motion);
    // Without effort the law only moves the torque limit, and the sharpest solution is the one that keeps it.
    if (objective < least || problem_->weights.effort == 0) {
      least = objective;
      best = solution_;
    }
  }
  solution_ = std::move(best);
  return status_ != SolveStatus::kStopped;
}

bool Continuation::begin(const Guess& guess) { return cold(guess) && refine_mesh(); }

bool Continuation::refine(const std::vector<double>& errors) {
  std::vector<double> wanted = errors;
  const std::vector<Limits> excess = excesses(*problem_, solution_.motion);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    for (std::size_t i = 0; i < Limits::kCount; ++i) {
      const double limit = problem_->limits.data()[i];
      const double margin = solution_.setup.margins.empty() ? 0 : solution_.setup.margins[k].data()[i];
      if (std::isfinite(limit) && excess[k].data()[i] + margin > kExcessWorthSplitting * limit) {
        wanted[k] = std::max(wanted[k], 1.5 * settings_.mesh_tolerance);
      }
    }
  }
  if (problem_->weights.effort > 0) {
    Pair<FrictionLaw> law{FrictionLaw::of(problem_->robot, 0), FrictionLaw::of(problem_->robot, 1)};
    for (FrictionLaw& l : law) l = l.smoothed(solution_.setup.friction_width);
    const std::vector<double> effort = effort_errors(law, settings_.scheme, solution_.motion);
    const double allowed = kEffortTolerance * solution_.report.objective / problem_->weights.effort;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (effort[k] > allowed) wanted[k] = std::max(wanted[k], 1.5 * settings_.mesh_tolerance);
    }
  }
  const std::vector<int> pieces = pieces_wanted(solution_.motion, wanted, settings_.mesh_tolerance,
                                                settings_.scheme.order, settings_.shortest_interval);
  CollocationSetup setup = solution_.setup;
  setup.mesh = split(setup.mesh, pieces);
  if (setup.mesh.size() == solution_.setup.mesh.size()) return false;
  setup.margins = inherited(setup.margins, pieces);
  setup.creep = inherited(setup.creep, pieces);
  const std::string what = fmt::format("{}, {} intervals", label, setup.mesh.size());
  SolveOptions warm = options(what);
  warm.warm_start = true;
  warm.initial_barrier = 1e-4;
  if (attempt(what, setup, nullptr, warm)) return true;
  if (status_ == SolveStatus::kStopped) return false;
  // Forgetting the multipliers and most of the closeness to bounds takes longer, and fails more rarely.
  const Guess guess = guess_from(solution_.motion, solution_.motion.duration());
  SolveOptions again = options(what + ", again");
  return attempt(what + ", again", setup, &guess, again);
}

bool Continuation::refine_mesh() {
  for (int round = 0; round < kMeshRounds; ++round) {
    if (!refine(interval_errors(problem_->robot, solution_.motion))) return status_ != SolveStatus::kStopped;
  }
  return true;
}

bool Continuation::keep_margins() {
  for (int round = 0; round < kMarginRounds; ++round) {
    CollocationSetup setup = solution_.setup;
    if (!widen(setup.margins, excesses(*problem_, solution_.motion))) return true;
    const std::string what = fmt::format("{}, margins", label);
    SolveOptions o = options(what);
    o.warm_start = true;
    o.initial_barrier = 1e-5;
    if (!attempt(what, setup, nullptr, o)) return false;
  }
  return true;
}

bool Continuation::keep_margins(const std::vector<LimitCheck>& checks) {
  std::vector<Limits> more(solution_.setup.mesh.size());
  for (Limits& l : more) std::fill_n(l.data(), Limits::kCount, 0.0);
  for (const LimitCheck& check : checks) {
    const double limit = check.limit * (1 - kBackOff);
    if (check.passed || check.reached <= limit) continue;
    const std::size_t at = solution_.motion.interval_at(check.time);
    for (std::size_t k = at > 0 ? at - 1 : 0; k < std::min(at + 2, more.size()); ++k) {
      *limit_of(more[k], check.name, check.joint) = check.reached - limit;
    }
  }
  CollocationSetup setup = solution_.setup;
  if (!widen(setup.margins, more)) return false;
  const std::string what = fmt::format("{}, margins from the certificate", label);
  SolveOptions o = options(what);
  o.warm_start = true;
  o.initial_barrier = 1e-5;
  return attempt(what, setup, nullptr, o) && keep_margins();
}

bool Continuation::creep() {
  bool any = false;
  for (int round = 0; round < kCreepRounds; ++round) {  // what is kept out of one interval may settle in the next
    CollocationSetup setup = solution_.setup;
    const std::vector<Pair<double>> wanted = creep_through_rests(*problem_, solution_.motion);
    setup.creep.resize(wanted.size(), {0, 0});
    bool more = false;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (wanted[k][j] == 0) continue;
        setup.creep[k][j] = wanted[k][j];
        more = true;
      }
    }
    if (!more) return any;
    const std::string what = fmt::format("{}, no unstable rest", label);
    SolveOptions o = options(what);
    o.warm_start = true;
    o.initial_barrier = 1e-4;
    if (!attempt(what, setup, nullptr, o)) return false;
    any = true;
  }
  return any;
}

bool Continuation::finish() {
  if (!follow_friction() || !refine_mesh()) return false;
  // Where margins cannot be had, the certificate decides about what there is.
  keep_margins();
  return status_ != SolveStatus::kStopped;
}

}  // namespace fjr
