#include "planner/search/continuation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/ocp/segments.h"
#include "planner/problem/task/task.h"
#include "planner/search/finer_mesh.h"
#include "planner/search/refinement.h"
#include "planner/search/tightening.h"

namespace fjr {
namespace {

// Returns whether an objective on a coarse mesh is more than `times_the_least` known one, if that is positive.
bool is_hopeless(const std::vector<double>& known, double objective, double times_the_least) {
  const auto least = std::min_element(known.begin(), known.end());
  return least != known.end() && *least > 0 && objective > times_the_least * *least;
}

// Returns the number of intervals of the first mesh.
int coarse_intervals(const Problem& problem, double duration, const FirstSolveSettings& s) {
  double intervals = duration / s.interval;
  if (can_be_jumped_over(problem.task)) {
    const bool hurried = !sees_friction(problem.weights);
    const double interval = hurried ? s.interval_among_obstacles : s.interval_without_hurry;
    const double most = hurried ? s.most_among_obstacles : s.most_without_hurry;
    intervals = std::max(intervals, std::min(duration / interval, most));
  }
  return std::clamp(static_cast<int>(std::ceil(intervals)), s.fewest_intervals, s.most_intervals) +
         s.intervals_per_via * static_cast<int>(problem.via.size());
}

// Returns the first mesh. A pause begins and ends at nodes.
Mesh first_mesh(const Problem& problem, const std::vector<double>& durations, int intervals) {
  const std::optional<Pause>& pause = problem.variation.pause;
  if (!pause) return uniform_mesh(durations, intervals);
  const double whole = problem.duration.max;
  const std::vector<double> parts{pause->begin, pause->duration(), whole - pause->end};
  Mesh mesh = uniform_mesh(parts, intervals);
  for (Mesh::Interval& interval : mesh.intervals) {
    interval.fraction *= parts[static_cast<std::size_t>(interval.segment)] / whole;
    interval.segment = 0;
  }
  return mesh;
}

// Finds the first solution. Our own method takes half the time, but twice as long as Ipopt for rewards, and it lacks
// the restoration of feasibility that tasks often need.
bool solve_first(Attempts& attempts, const ContinuationOptions& options, const ContinuationStrategy& strategy,
                 const Guess& guess, int most_iterations) {
  const Problem& problem = attempts.problem();
  const std::string what = fmt::format("{}, {}", attempts.label(), guess.name);
  SolveOptions o = attempts.options(what);
  o.max_iterations = most_iterations;
  const bool plain_and_fastest = only_time(problem.weights) && count_of_rows(problem.task) == 0;
  const bool own = !has_reward(problem.weights) && (options.by_interior_point || plain_and_fastest);
  o.optimiser = own ? Optimiser::kInteriorPoint : Optimiser::kIpopt;
  if (own && options.barrier) o.initial_barrier = *options.barrier;
  const double intervals = options.mesh_factor * coarse_intervals(problem, guess.duration(), attempts.settings().first);
  Smoothing smoothest = strategy.steps.front();
  smoothest.regularisation *= options.regularisation_factor;
  smoothest.friction_width *= options.width_factor;
  const CollocationSetup setup{attempts.session().options().scheme,
                               first_mesh(problem, guess.durations, static_cast<int>(std::lround(intervals))),
                               smoothest,
                               {}};
  return attempts.from_guess(what, setup, guess, o);
}

// Returns whether a start that reached its iteration limit goes on: its objective is below all known minima and its
// constraints nearly hold.
bool is_ahead_of(const std::vector<double>& known, const Attempts& attempts) {
  const FirstSolveSettings& s = attempts.settings().first;
  const auto least = std::min_element(known.begin(), known.end());
  return attempts.status() == SolveStatus::kIterationLimit && least != known.end() &&
         attempts.violation() < s.small_violation &&
         attempts.stages().back().objective < *least - s.same_minimum * std::abs(*least);
}

}  // namespace

bool any_same(const std::vector<double>& minima, double objective, double difference) {
  return std::any_of(minima.begin(), minima.end(), [=](double other) {
    return std::abs(objective - other) <= difference * std::max(std::abs(objective), std::abs(other));
  });
}

Continuation::Continuation(std::shared_ptr<const Problem> problem, Session& session, std::string label,
                           ContinuationOptions options)
    : options_(std::move(options)),
      strategy_(options_.strategy.value_or(usual_strategy(*problem))),
      attempts_(std::move(problem), session, std::move(label), options_.iteration_factor) {}

StartOutcome Continuation::begin(const Guess& guess, int most_iterations, const std::vector<double>& known) {
  const Problem& problem = attempts_.problem();
  const ContinuationSettings& s = attempts_.settings();
  bool solved = solve_first(attempts_, options_, strategy_, guess, most_iterations);
  if (!solved && is_ahead_of(known, attempts_)) {
    attempts_.forget_stages();  // the first stage is what the start comes to
    solved = solve_first(attempts_, options_, strategy_, guess, s.first.iteration_factor_when_ahead * most_iterations);
  }
  if (!solved) return StartOutcome::kNoSolution;
  const double objective = solution().report.objective;
  if (any_same(known, objective, s.first.same_minimum)) return StartOutcome::kKnown;
  // If the objective does not depend on friction, the next steps refine the mesh anyway, and the multipliers change
  // little before: not refining here saves a tenth of the iterations. Otherwise the rests of motors have to be resolved
  // while the law is smooth; without that, objectives are 0.5 % higher.
  if (!sees_friction(problem.weights) || is_hopeless(known, objective, s.first.hopeless)) return StartOutcome::kNew;
  const CollocationSetup setup =
      with_finer_mesh(problem, solution(), solution().setup, interval_errors(problem.robot, solution().motion),
                      demand_on_the_way(s), s.mesh);
  const std::string what = fmt::format("{}, {} intervals", label(), setup.mesh.size());
  if (setup.mesh.size() != solution().setup.mesh.size()) {
    // A second attempt, without the multipliers, takes as long as the first and hardly ever leads to the best motion.
    if (known.empty()) {
      attempts_.warm_or_anew(what, setup, attempts_.warm_options(what), strategy_);
    } else {
      attempts_.warm(what, setup, attempts_.warm_options(what));
    }
  }
  return attempts_.stopped() ? StartOutcome::kNoSolution : StartOutcome::kNew;
}

ResumeOutcome Continuation::resume(const Collocated& neighbour, Beginning beginning) {
  const Problem& problem = attempts_.problem();
  if (static_cast<std::size_t>(neighbour.setup.mesh.segments()) != segment_count(problem))
    return ResumeOutcome::kOtherSegments;
  Collocated adapted = neighbour;
  // Settings that were fitted to the other problem may not suit this one.
  CollocationSetup& setup = adapted.setup;
  setup.creep.clear();
  const Smoothing& exact = strategy_.steps.back();
  setup.smoothing.regularisation = std::min(setup.smoothing.regularisation, exact.regularisation);
  if (!sees_friction(problem.weights)) setup.smoothing.friction_width = exact.friction_width;
  const std::size_t limits = limit_scales(problem).size();
  if (limits > kLimits || (!setup.margins.empty() && setup.margins.front().size() != limits)) {
    setup.margins.clear();
  }
  attempts_.replace(std::move(adapted));
  const std::string what = label() + ", moved";
  // If this does not converge soon, planning from scratch takes less time on average than a second attempt.
  const ContinuationSettings& s = attempts_.settings();
  SolveOptions o = attempts_.warm_options(what);
  o.beginning = beginning;
  o.max_iterations = problem.variation.price ? s.warm.iterations_to_another_price : s.homotopy.iterations;
  if (!attempts_.warm(what, CollocationSetup(solution().setup), o)) {
    if (!attempts_.start_fitted()) return ResumeOutcome::kOtherConstraints;
    return attempts_.stopped() ? ResumeOutcome::kStopped : ResumeOutcome::kNoSolution;
  }
  const Completion tightened = tighten_on_moved_nodes(attempts_, strategy_, failures_to_tighten_);
  return tightened == Completion::kFinished ? ResumeOutcome::kSolved : ResumeOutcome::kStopped;
}

bool Continuation::adopt(const Collocated& other, double duration) {
  const std::string what = label() + ", stretched";
  const Guess guess = guess_from(other.motion, other.durations, duration);
  return attempts_.from_guess(what, other.setup, guess, attempts_.options(what));
}

bool Continuation::take_over(const Collocated& motion, double friction_width, double barrier, int most_iterations) {
  const std::string what = label() + ", taken over";
  CollocationSetup setup = motion.setup;
  setup.smoothing.friction_width = friction_width;
  SolveOptions o = attempts_.options(what);
  o.max_iterations = most_iterations;
  o.optimiser = Optimiser::kInteriorPoint;
  o.initial_barrier = barrier;
  return attempts_.from_guess(what, setup, guess_of(motion), o);
}

StepOutcome Continuation::take_step() {
  if (!homotopy_) homotopy_.emplace(attempts_, strategy_);
  return homotopy_->take_step(attempts_, strategy_);
}

Completion Continuation::keep_best_step() {
  if (homotopy_) homotopy_->keep_best(attempts_);
  homotopy_.reset();
  return attempts_.stopped() ? Completion::kStopped : fade_regularisation(attempts_, strategy_);
}

Completion Continuation::follow_homotopy() {
  while (take_step() == StepOutcome::kTaken) continue;
  return keep_best_step();
}

Completion Continuation::settle() {
  if (keep_best_step() == Completion::kStopped) return Completion::kStopped;
  return tighten_on_moved_nodes(attempts_, strategy_, failures_to_tighten_);
}

Completion Continuation::refine() {
  while (take_step() == StepOutcome::kTaken) continue;
  return settle();
}

Completion Continuation::tighten() { return fjr::tighten(attempts_, strategy_, failures_to_tighten_); }

ChangeOutcome Continuation::split_intervals(const std::vector<double>& errors) {
  return split_by_errors(errors, attempts_, strategy_);
}

ChangeOutcome Continuation::keep_margins(const std::vector<LimitCheck>& checks) {
  const ChangeOutcome widened = widen_by_checks(checks, attempts_);
  if (widened == ChangeOutcome::kSolved) tighten();
  return widened;
}

ChangeOutcome Continuation::keep_margins_of_rollout(const std::vector<LimitCheck>& checks) {
  const ChangeOutcome widened = widen_by_rollout(checks, attempts_);
  if (widened == ChangeOutcome::kSolved) tighten();
  return widened;
}

ChangeOutcome Continuation::creep(double shortest) { return keep_motors_moving(attempts_, shortest); }

}  // namespace fjr
