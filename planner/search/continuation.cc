#include "planner/search/continuation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "planner/analysis/node_times.h"
#include "planner/ocp/arm_ocp.h"
#include "planner/ocp/margins.h"
#include "planner/ocp/moving_nodes.h"
#include "planner/ocp/objective.h"
#include "planner/ocp/rests.h"
#include "planner/ocp/segments.h"
#include "planner/problem/task/task.h"
#include "planner/search/creep.h"
#include "planner/search/refinement.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

// Returns the error above which intervals make up the sum of all errors but for a fraction `others_of_sum`.
double bulk_of(std::vector<double> errors, double others_of_sum) {
  const double sum = std::accumulate(errors.begin(), errors.end(), 0.0);
  std::sort(errors.begin(), errors.end());
  double others = 0;
  for (const double error : errors) {
    others += error;
    if (others > others_of_sum * sum) return error * (1 - 1e-9);
  }
  return kNoLimit;
}

// Returns whether an objective on a coarse mesh is more than `times_the_least` known one, if that is positive.
bool is_hopeless(const std::vector<double>& known, double objective, double times_the_least) {
  const auto least = std::min_element(known.begin(), known.end());
  return least != known.end() && *least > 0 && objective > times_the_least * *least;
}

bool exceeds(const std::vector<PerLimit>& excesses) {
  return std::any_of(excesses.begin(), excesses.end(), [](const PerLimit& here) {
    return std::any_of(here.begin(), here.end(), [](double excess) { return excess > 0; });
  });
}

// int u^2 [N^2 m^2 s]
double squared_torque(const Motion& motion) {
  double sum = 0;
  for (std::size_t k = 0; k < motion.intervals.size(); ++k) {
    const auto& interval = motion.intervals[k];
    const double weights[] = {1.0 / 6, 4.0 / 6, 1.0 / 6};  // Simpson's rule
    for (int i = 0; i < 3; ++i) {
      const Joints<double> u = motion.torque_in(k, interval.start + 0.5 * i * interval.duration);
      sum += weights[i] * interval.duration * (u[0] * u[0] + u[1] * u[1]);
    }
  }
  return sum;
}

// Returns the number of intervals of the first mesh.
int coarse_intervals(const Problem& problem, double duration, const FirstSolveSettings& s) {
  double intervals = duration / s.interval;
  if (!problem.task.obstacles.discs.empty()) {
    intervals = std::max(intervals, std::min(duration / s.interval_among_obstacles, s.most_among_obstacles));
  }
  return std::clamp(static_cast<int>(std::ceil(intervals)), s.fewest_intervals, s.most_intervals) +
         s.intervals_per_via * static_cast<int>(problem.via.size());
}

}  // namespace

bool any_same(const std::vector<double>& minima, double objective, double difference) {
  return std::any_of(minima.begin(), minima.end(), [=](double other) {
    return std::abs(objective - other) <= difference * std::max(std::abs(objective), std::abs(other));
  });
}

Continuation::Continuation(std::shared_ptr<const Problem> problem, Session& session, std::string label)
    : strategy(usual_strategy(*problem)), problem_(std::move(problem)), session_(&session), label_(std::move(label)) {}

SolveOptions Continuation::options(const std::string& what) {
  SolveOptions o;
  o.linear_solver = session_->options().linear_solver;
  o.max_iterations = static_cast<int>(std::lround(patience * settings().warm.iterations));
  o.monitor = [this, what, told = 0.0](const IterationInfo& info) mutable {
    session_->tell({what, info.iteration, info.objective, info.violation});
    const double more = info.work - std::exchange(told, info.work);
    return !session_->interrupted(more);
  };
  return o;
}

// Margins that are all zero are the same as none.
bool Continuation::Attempt::same_as(const Attempt& other) const {
  const auto none = [](const PerLimit& margins) {
    return std::all_of(margins.begin(), margins.end(), [](double margin) { return margin == 0; });
  };
  const auto margins = [&](const CollocationSetup& s) {
    return std::all_of(s.margins.begin(), s.margins.end(), none) ? std::vector<PerLimit>{} : s.margins;
  };
  const Smoothing &a = setup.smoothing, &b = other.setup.smoothing;
  return how == other.how && most_iterations == other.most_iterations && barrier == other.barrier &&
         setup.mesh == other.setup.mesh && a.friction_width == b.friction_width &&
         a.regularisation == b.regularisation && setup.creep == other.setup.creep &&
         margins(setup) == margins(other.setup);
}

// A warm start (no guess) begins from the present solution and its multipliers, on the same mesh.
bool Continuation::attempt(const std::string& what, const CollocationSetup& setup, const Guess* guess,
                           const SolveOptions& o) {
  if (guess == nullptr) {
    return attempt_once(what, {setup, Attempt::kWarm, o.max_iterations, o.initial_barrier}, o,
                        [&](const SolveOptions& with) { return collocate(*problem_, setup, solution_, with); });
  }
  return attempt_once(what, {setup, Attempt::kFromGuess, o.max_iterations, o.initial_barrier}, o,
                      [&](const SolveOptions& with) { return collocate(*problem_, setup, *guess, with); });
}

// An attempt that failed from the present solution would fail again, so it is not repeated.
bool Continuation::attempt_once(const std::string& what, Attempt attempt, const SolveOptions& o,
                                const std::function<Collocated(const SolveOptions&)>& solve) {
  if (session_->interrupted()) {
    status_ = SolveStatus::kStopped;
    return false;
  }
  for (const Attempt& before : failed_) {
    if (!before.same_as(attempt)) continue;
    status_ = before.status;
    return false;
  }
  Collocated next = session_->in_pairs([&](const DoBoth& both) {
    SolveOptions in_pairs = o;
    in_pairs.both = both;
    return solve(in_pairs);
  });
  const std::size_t intervals = next.setup.mesh.size();
  status_ = next.report.status;
  stages_.push_back({what, static_cast<int>(intervals), next.report.iterations, next.report.objective,
                     name(next.report.status), next.report.cost, next.report.work});
  session_->add(stages_.back());
  violation_ = next.report.violation;
  if (!next.report.solved()) {
    attempt.status = status_;
    failed_.push_back(std::move(attempt));
    if (!next.motion.intervals.empty()) obstacle_ = worst_excess(*problem_, next.setup.mesh, next.motion);
    return false;
  }
  solution_ = std::move(next);
  failed_.clear();
  ++solutions_;
  return true;
}

// Finds the first solution. Tasks with path constraints are solved by Ipopt, because they often need feasibility
// restoration, which our own method lacks; so are rewards, for which our own method takes twice as long.
bool Continuation::cold(const Guess& guess, int most_iterations) {
  const std::string what = fmt::format("{}, {}", label_, guess.name);
  SolveOptions o = options(what);
  o.max_iterations = most_iterations;
  const bool suits_own = count_of_rows(problem_->task) == 0 && !has_reward(problem_->weights);
  const bool own = suits_own && (by_own_method || only_time(problem_->weights));
  o.optimiser = own ? Optimiser::kOwn : Optimiser::kIpopt;
  const int usual = coarse_intervals(*problem_, guess.duration(), settings().first);
  Smoothing smoothest = strategy.steps.front();
  smoothest.regularisation *= regularisation_factor;
  smoothest.friction_width *= width_factor;
  const CollocationSetup setup{session_->options().scheme,
                               uniform_mesh(guess.durations, static_cast<int>(std::lround(mesh_factor * usual))),
                               smoothest,
                               {}};
  return attempt(what, setup, &guess, o);
}

// Returns whether the last attempt, although it found no solution, lowered the objective by a fraction worth continuing
// for.
bool Continuation::came_down() const {
  const double before = solution_.report.objective;
  return sees_friction(problem_->weights) &&
         stages_.back().objective < before - settings().warm.worthwhile_decrease * std::abs(before);
}

// Whether friction is in the objective, so that a motor may rest and carry a load at no cost.
bool Continuation::has_rests() const { return sees_friction(problem_->weights) && !problem_->slack; }

bool Continuation::attempt_step(const std::string& what, const CollocationSetup& setup) {
  const double width = setup.smoothing.friction_width;
  const bool scaled = has_rests() && width <= settings().homotopy.rest_width;
  const Collocated from = scaled ? with_rests_scaled(*problem_, solution_, width) : solution_;
  SolveOptions o = strategy.loose_steps ? loosely(what) : warm(what);
  const auto within = [&](double iterations) {
    o.max_iterations = static_cast<int>(std::lround(patience * iterations));
    const std::size_t before = stages_.size();
    const bool solved = attempt_once(what, {setup, Attempt::kWarm, o.max_iterations, o.initial_barrier}, o,
                                     [&](const SolveOptions& with) { return collocate(*problem_, setup, from, with); });
    if (stages_.size() > before && status_ == SolveStatus::kIterationLimit) ++session_->fallbacks().friction_level;
    return solved;
  };
  const bool rewarded = has_reward(problem_->weights);
  if (within(scaled     ? settings().homotopy.iterations_with_rests
             : rewarded ? settings().homotopy.iterations_with_reward
                        : settings().homotopy.iterations))
    return true;
  return status_ == SolveStatus::kIterationLimit && came_down() && within(settings().warm.more_iterations);
}

// Moves the nodes at which the Hamiltonian jumps to their optimal times. Returns false if there was nothing to move or
// no solution was found; then the last solution stays.
bool Continuation::move_nodes() {
  if (!has_rests()) return false;
  const NodeTimes times = node_times(*problem_, solution_);
  if (times.spread <= times.allowed || times.jumps.empty()) return false;
  const std::string what = fmt::format("{}, {} nodes moved", label_, times.jumps.size());
  SolveOptions o = warm(what);
  const auto within = [&](int iterations) {
    o.max_iterations = iterations;
    return attempt_once(
        what, {solution_.setup, Attempt::kMovingNodes, o.max_iterations, o.initial_barrier}, o,
        [&](const SolveOptions& with) { return fjr::move_nodes(*problem_, solution_, times.jumps, with); });
  };
  if (within(settings().nodes.iterations)) return true;
  // With a sharper law, attempts whose objective still falls at the limit of iterations seldom converge later.
  const bool smooth = solution_.setup.smoothing.friction_width >= settings().nodes.first_width;
  return smooth && status_ == SolveStatus::kIterationLimit && came_down() && within(settings().warm.more_iterations);
}

// Moves nodes and tightens, more than once if the refined mesh needs some nodes elsewhere again. Returns false if no
// usable solution is left.
bool Continuation::tighten_on_moved_nodes() {
  move_nodes();
  for (int round = 0; status_ != SolveStatus::kStopped && tighten(); ++round) {
    if (round + 1 >= settings().nodes.rounds || !move_nodes()) return status_ != SolveStatus::kStopped;
  }
  return false;
}

// Takes a homotopy step, in two halves if it fails.
bool Continuation::reach_step(const Smoothing& step, int halvings) {
  const std::string what = fmt::format("{}, friction width {:.2g} rad/s", label_, step.friction_width);
  CollocationSetup setup =
      refined(solution_.setup, interval_errors(problem_->robot, solution_.motion), settings().homotopy.mesh_tolerance);
  const Smoothing from = setup.smoothing;
  setup.smoothing = step;
  if (attempt_step(what, setup)) return true;
  // If the objective depends on friction, the steps are small already, and the last good solution will do.
  if (status_ == SolveStatus::kStopped || sees_friction(problem_->weights)) return false;
  if (halvings == 0) return attempt_anew(what, setup);
  const double sharpest = std::max(step.friction_width, settings().homotopy.sharp_width);
  const Smoothing between{std::sqrt(from.friction_width * sharpest),
                          std::sqrt(from.regularisation * step.regularisation)};
  return reach_step(between, halvings - 1) && reach_step(step, halvings - 1);
}

void Continuation::compare_step() {
  Homotopy& h = *homotopy_;
  const double objective = published_objective(*problem_, solution_);
  // If the objective does not depend on friction, the law only shifts the torque limit, so the sharpest solution is
  // kept.
  if (!(objective < h.least) && sees_friction(problem_->weights)) return;
  h.least = objective;
  h.best = solution_;
  h.best_at = solutions_;
}

// Each step's solution starts the next one, on a mesh refined by its errors. The solution with the least published
// objective (with the exact law) is kept: a sharper law usually helps, but sometimes a step ends in a worse minimum or
// fails.
bool Continuation::take_step() {
  const std::vector<Smoothing>& steps = strategy.steps;
  if (!homotopy_) {
    const double width = solution_.setup.smoothing.friction_width;
    std::size_t next = 1;
    while (next < steps.size() && steps[next].friction_width >= width) ++next;
    homotopy_ = Homotopy{next, solution_, solutions_, published_objective(*problem_, solution_)};
  }
  if (homotopy_->next >= steps.size()) return false;
  const Smoothing& step = steps[homotopy_->next++];
  // A step often fails because the mesh holds the switching times where they are: then nodes are moved first.
  const auto reach = [&] {
    if (reach_step(step, settings().homotopy.halvings)) return true;
    if (status_ == SolveStatus::kStopped || !move_nodes()) return false;
    compare_step();
    return reach_step(step, settings().homotopy.halvings);
  };
  if (!reach()) {
    homotopy_->next = steps.size();
    return false;
  }
  compare_step();
  if (step.friction_width == settings().nodes.first_width && move_nodes()) compare_step();
  return true;
}

bool Continuation::follow_homotopy() {
  while (take_step()) continue;
  return keep_best_step();
}

bool Continuation::keep_best_step() {
  if (homotopy_) {
    if (homotopy_->best_at != solutions_) failed_.clear();
    solution_ = std::move(homotopy_->best);
    homotopy_.reset();
  }
  return status_ != SolveStatus::kStopped && fade_regularisation();
}

// Reduces the regularisation by effort, which selects among torques, until it is small beside the objective. It would
// outweigh an objective that is much smaller than its weights suggest. Returns false if stopped.
bool Continuation::fade_regularisation() {
  if (settles_torque(problem_->weights) || !strategy.fades) return true;
  for (int round = 0; round < settings().regularisation.rounds; ++round) {
    Smoothing step = solution_.setup.smoothing;
    const double weight = make_arm_ocp<Features{}>(*problem_, step.regularisation).regularisation;
    const double regularisation = weight * squared_torque(solution_.motion);
    const double objective = std::abs(solution_.report.objective - regularisation);
    if (!(regularisation > settings().regularisation.largest * objective)) return true;
    step.regularisation *=
        std::max(settings().regularisation.decrease * settings().regularisation.largest * objective / regularisation,
                 settings().regularisation.largest_change);
    if (!reach_step(step, settings().homotopy.halvings)) return status_ != SolveStatus::kStopped;
  }
  return true;
}

// Returns whether a start that reached its iteration limit goes on: its objective is below all known minima and its
// constraints nearly hold.
bool Continuation::is_ahead_of(const std::vector<double>& known) const {
  const auto least = std::min_element(known.begin(), known.end());
  return status_ == SolveStatus::kIterationLimit && least != known.end() &&
         violation_ < settings().first.small_violation &&
         stages_.back().objective < *least - settings().first.same_minimum * std::abs(*least);
}

StartOutcome Continuation::begin(const Guess& guess, int most_iterations, const std::vector<double>& known) {
  bool solved = cold(guess, most_iterations);
  if (!solved && is_ahead_of(known)) {
    stages_.clear();  // the first stage is what the start comes to
    solved = cold(guess, settings().first.iteration_factor_when_ahead * most_iterations);
  }
  if (!solved) return StartOutcome::kNoSolution;
  if (any_same(known, solution_.report.objective, settings().first.same_minimum)) return StartOutcome::kKnown;
  // If the objective does not depend on friction, the next steps refine the mesh anyway, and the multipliers change
  // little before: not refining here saves a tenth of the iterations. Otherwise the rests of motors have to be resolved
  // while the law is smooth; without that, objectives are 0.5 % higher.
  if (!sees_friction(problem_->weights) || is_hopeless(known, solution_.report.objective, settings().first.hopeless))
    return StartOutcome::kNew;
  const CollocationSetup setup =
      refined(solution_.setup, interval_errors(problem_->robot, solution_.motion), settings().homotopy.mesh_tolerance);
  const std::string what = fmt::format("{}, {} intervals", label_, setup.mesh.size());
  if (setup.mesh.size() != solution_.setup.mesh.size()) {
    // A second attempt, without the multipliers, takes as long as the first and hardly ever leads to the best motion.
    if (known.empty()) {
      attempt_or_forget(what, setup, warm(what));
    } else {
      attempt(what, setup, nullptr, warm(what));
    }
  }
  return status_ == SolveStatus::kStopped ? StartOutcome::kNoSolution : StartOutcome::kNew;
}

// Returns the setup with those intervals split whose error [rad] exceeds the tolerance, that exceed a limit by much, or
// whose cost is inaccurate. If a motor reverses at its torque limit, u has to jump by the step of its friction. Nodes
// are placed on both sides of the jump, because halving would take three more rounds to come as near.
CollocationSetup Continuation::refined(CollocationSetup setup, std::vector<double> errors, double tolerance) const {
  const double worth_splitting = settings().mesh.error_when_splitting * tolerance,
               worth_quartering = std::pow(2, session_->options().scheme.order + 2) * tolerance;
  const bool on_the_way = tolerance > mesh_tolerance();
  const double worth = on_the_way ? settings().mesh.excess_worth_splitting
                                  : strategy.worth_splitting.value_or(settings().mesh.excess_worth_splitting);
  const std::vector<PerLimit> excess =
      excesses(*problem_, solution_.setup.mesh, solution_.motion, kKeep, solution_.slack);
  const PerLimit scales = limit_scales(*problem_);
  Cuts steps(errors.size());  // of the friction torque, where they make a torque exceed its limit
  for (std::size_t k = 0; k < errors.size(); ++k) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
      const double margin = setup.margins.empty() ? 0 : setup.margins[k][i];
      const double fraction = (excess[k][i] + margin) / scales[i];  // zero without a limit
      if (fraction <= worth) continue;
      const bool of_torque = i < kLimits && kLimitNames[i].is_of(Torque::info);
      if (of_torque && fraction > settings().mesh.excess_worth_splitting) {
        if (const auto reversal = reversal_in(solution_.motion, k, kLimitNames[i].j())) {
          steps[k].push_back(*reversal);
          continue;
        }
      }
      errors[k] = std::max(errors[k], worth_splitting);
      if (fraction > settings().mesh.excess_worth_quartering * worth) errors[k] = std::max(errors[k], worth_quartering);
    }
  }
  if (sees_friction(problem_->weights)) {
    Joints<FrictionLaw> law{FrictionLaw::of(problem_->robot, 0), FrictionLaw::of(problem_->robot, 1)};
    for (FrictionLaw& l : law) l = l.smoothed(setup.smoothing.friction_width);
    const std::vector<double> cost = cost_errors(*problem_, law, session_->options().scheme, solution_.motion);
    const double allowed = settings().mesh.cost_tolerance * std::abs(solution_.report.objective);
    for (std::size_t k = 0; k < errors.size(); ++k) {
      if (cost[k] > allowed) errors[k] = std::max(errors[k], worth_splitting);
    }
  }
  std::vector<int> pieces = affordable_pieces(errors, tolerance);
  Cuts cuts = equal_cuts(pieces);
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const double shortest = settings().mesh.shortest_interval / solution_.motion.intervals[k].duration;
    for (const double step : steps[k]) cut_around(cuts[k], step, shortest);
    pieces[k] = static_cast<int>(cuts[k].size()) + 1;
  }
  setup.mesh = split(setup.mesh, cuts);
  for (std::size_t k = 0; k < setup.margins.size(); ++k) {  // split intervals may not need them
    if (pieces[k] > 1) std::fill(setup.margins[k].begin(), setup.margins[k].end(), 0.0);
  }
  setup.margins = inherited(setup.margins, pieces);
  setup.creep = inherited(setup.creep, pieces);
  return setup;
}

double Continuation::mesh_tolerance() const { return strategy.mesh * settings().mesh.tolerance; }

// Returns into how many pieces each interval is split. If that gives too many intervals, only the worst are split.
std::vector<int> Continuation::affordable_pieces(const std::vector<double>& errors, double tolerance) const {
  const auto count = [](const std::vector<int>& pieces) {
    return static_cast<std::size_t>(std::accumulate(pieces.begin(), pieces.end(), 0));
  };
  std::vector<int> pieces;
  do {
    pieces = pieces_wanted(solution_.motion, errors, tolerance, session_->options().scheme.order,
                           settings().mesh.shortest_interval);
    tolerance *= settings().mesh.looser;
  } while (count(pieces) > std::max(most_intervals(), errors.size()));
  return pieces;
}

// Returns the options of a warm start. Rewards are solved by Ipopt: a reward is maximised, so its Hessian is not
// positive definite at the solution. There our own method takes 1.6 times Ipopt's iterations (bench/README.md), and
// some of its solutions miss the certificate.
SolveOptions Continuation::warm(const std::string& what) {
  SolveOptions o = options(what);
  o.warm_start = true;
  o.optimiser = has_reward(problem_->weights) ? Optimiser::kIpopt : Optimiser::kOwn;
  o.barrier_strategy = BarrierStrategy::kMonotone;
  o.initial_barrier = o.final_barrier = settings().warm.barrier;
  return o;
}

// The more rows an interval has, the more memory it takes.
std::size_t Continuation::most_intervals() const {
  const double rows = static_cast<double>(count_of_rows(problem_->task));
  const double without_task = settings().mesh.rows_without_task;
  return static_cast<std::size_t>(static_cast<double>(settings().mesh.most_intervals) * without_task /
                                  (without_task + rows));
}

bool Continuation::attempt_or_forget(const std::string& what, const CollocationSetup& setup, const SolveOptions& o) {
  if (attempt(what, setup, nullptr, o)) return true;
  return status_ != SolveStatus::kStopped && strategy.begins_afresh && attempt_anew(what, setup);
}

// Solves from the present motion without its multipliers and further from the bounds. This takes longer than a warm
// start, and fails more rarely.
bool Continuation::attempt_anew(const std::string& what, const CollocationSetup& setup) {
  const Guess guess = guess_from(solution_.motion, solution_.durations, solution_.motion.duration());
  const std::size_t solves = stages_.size();
  const bool solved = attempt(what + ", again", setup, &guess, options(what + ", again"));
  if (stages_.size() > solves) ++session_->fallbacks().adaptive_barrier;
  return solved;
}

ChangeOutcome Continuation::split_intervals(const std::vector<double>& errors) {
  if (errors.size() != solution_.setup.mesh.size()) throw std::logic_error("errors of another mesh");
  const CollocationSetup setup =
      refined(solution_.setup, errors, std::min(mesh_tolerance(), bulk_of(errors, settings().mesh.others_of_sum)));
  if (setup.mesh.size() == solution_.setup.mesh.size()) return ChangeOutcome::kNotNeeded;
  const std::string what = fmt::format("{}, {} intervals", label_, setup.mesh.size());
  return attempt_or_forget(what, setup, warm(what)) ? ChangeOutcome::kSolved : ChangeOutcome::kFailed;
}

SolveOptions Continuation::loosely(const std::string& what) {
  SolveOptions o = warm(what);
  if (sees_friction(problem_->weights)) return o;
  o.tolerance = settings().tightening.round_tolerance;
  o.constraint_tolerance = settings().tightening.round_violation;
  return o;
}

bool Continuation::solved_loosely() const { return solution_.report.tolerance > SolveOptions{}.tolerance; }

// Solves with the usual tolerances after a loose solve. If that fails, the last solution stays.
void Continuation::solve_to_the_end() {
  const std::string what = fmt::format("{}, to the end", label_);
  if (solved_loosely()) attempt(what, CollocationSetup(solution_.setup), nullptr, warm(what));
}

// Keeps the solution with the least peak torque in its rows of all rounds that keep the limits; it need not be the last
// one. Where a motor reverses, a peak that is lowered in one interval can come up in the next.
void Continuation::keep_lowest_peak(std::optional<Collocated> best) {
  if (!best || published_objective(*problem_, *best) >= published_objective(*problem_, solution_)) return;
  solution_ = *std::move(best);
  failed_.clear();
}

bool Continuation::tighten() {
  // With wider laws the friction differs from the exact one even where a motor is not yet reversing.
  bool minds_peak = problem_->weights.peak_torque > 0 &&
                    solution_.setup.smoothing.friction_width <= settings().tightening.sharp_for_peaks;
  std::optional<Collocated> lowest;
  for (int round = 0; round < settings().tightening.rounds && failures_to_tighten_ < settings().tightening.failures;
       ++round) {
    CollocationSetup setup = solution_.setup;
    const double keep =
        round < settings().tightening.rounds_of_whole_margin ? kKeep : settings().tightening.later_part_of_margin;
    const double growth = round > 0 && solution_.report.iterations == 0 ? settings().tightening.ineffective_growth
                                                                        : settings().tightening.growth;
    std::vector<PerLimit> excess = excesses(*problem_, setup.mesh, solution_.motion, keep, solution_.slack);
    if (minds_peak && round > 0 && !exceeds(excess) &&
        (!lowest || published_objective(*problem_, solution_) < published_objective(*problem_, *lowest))) {
      lowest = solution_;
    }
    if (minds_peak) add_excesses_of_peak(excess, *problem_, solution_.motion, solution_.peak);
    const bool wider = widen(setup.margins, excess, *problem_, growth);
    setup = refined(std::move(setup), interval_errors(problem_->robot, solution_.motion), mesh_tolerance());
    const bool finer = setup.mesh.size() != solution_.setup.mesh.size();
    if (!wider && !finer) {
      if (!solved_loosely()) break;
      solve_to_the_end();
      if (solved_loosely()) break;
      continue;
    }
    const std::string what = fmt::format("{}, {} intervals{}", label_, setup.mesh.size(), wider ? " and margins" : "");
    if (attempt_or_forget(what, setup, loosely(what))) continue;
    if (status_ == SolveStatus::kStopped || !minds_peak) {
      ++failures_to_tighten_;
      break;
    }
    minds_peak = false;  // solves once more for limits and mesh alone, without lowering the peak
  }
  if (status_ == SolveStatus::kStopped) return false;
  solve_to_the_end();
  keep_lowest_peak(std::move(lowest));
  return status_ != SolveStatus::kStopped;
}

ChangeOutcome Continuation::keep_margins(const std::vector<LimitCheck>& checks) {
  std::vector<PerLimit> more(solution_.setup.mesh.size(), PerLimit(limit_scales(*problem_).size(), 0.0));
  for (const LimitCheck& check : checks) {
    const double limit = check.limit * (1 - kBaseMargin);
    if (check.passed || check.reached <= check.limit) continue;
    const std::size_t at = solution_.motion.interval_at(check.time);
    for (std::size_t k = at > 0 ? at - 1 : 0; k < std::min(at + 2, more.size()); ++k) {
      more[k][check.index] = check.reached - limit;
    }
  }
  CollocationSetup setup = solution_.setup;
  if (!widen(setup.margins, more, *problem_)) return ChangeOutcome::kNotNeeded;
  const std::string what = fmt::format("{}, margins from the certificate", label_);
  if (!attempt(what, setup, nullptr, warm(what))) return ChangeOutcome::kFailed;
  tighten();
  return ChangeOutcome::kSolved;
}

ChangeOutcome Continuation::creep() {
  ChangeOutcome done = ChangeOutcome::kNotNeeded;
  for (int round = 0; round < settings().tightening.creep_rounds; ++round) {
    CollocationSetup setup = solution_.setup;
    const std::vector<Joints<double>> wanted = creep_through_rests(*problem_, solution_.motion);
    setup.creep.resize(wanted.size(), {0, 0});
    bool more = false;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (wanted[k][j] == 0) continue;
        setup.creep[k][j] = wanted[k][j];
        more = true;
      }
    }
    if (!more) return done;
    const std::string what = fmt::format("{}, no unstable rest", label_);
    if (!attempt(what, setup, nullptr, warm(what)))
      return done == ChangeOutcome::kSolved ? done : ChangeOutcome::kFailed;
    done = ChangeOutcome::kSolved;
  }
  return done;
}

bool Continuation::adopt(const Collocated& other, double duration) {
  const std::string what = label_ + ", stretched";
  const Guess guess = guess_from(other.motion, other.durations, duration);
  return attempt(what, other.setup, &guess, options(what));
}

bool Continuation::resume(const Collocated& neighbour) {
  if (static_cast<std::size_t>(neighbour.setup.mesh.segments()) != segment_count(*problem_)) return false;
  solution_ = neighbour;
  // Settings that were fitted to the other problem may not suit this one.
  CollocationSetup& setup = solution_.setup;
  setup.creep.clear();
  const Smoothing& exact = strategy.steps.back();
  setup.smoothing.regularisation = std::min(setup.smoothing.regularisation, exact.regularisation);
  if (!sees_friction(problem_->weights)) setup.smoothing.friction_width = exact.friction_width;
  const std::size_t limits = limit_scales(*problem_).size();
  if (limits > kLimits || (!setup.margins.empty() && setup.margins.front().size() != limits)) {
    setup.margins.clear();
  }
  const std::string what = label_ + ", moved";
  // If this does not converge soon, planning from scratch takes less time on average than a second attempt.
  SolveOptions o = warm(what);
  o.max_iterations = problem_->price ? settings().warm.iterations_to_another_price : settings().homotopy.iterations;
  return attempt(what, CollocationSetup(solution_.setup), nullptr, o) && tighten_on_moved_nodes();
}

// If no solution with margins is found, the certificate decides about the last one.
bool Continuation::settle() { return keep_best_step() && tighten_on_moved_nodes(); }

bool Continuation::refine() {
  while (take_step()) continue;
  return settle();
}

}  // namespace fjr
