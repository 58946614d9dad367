#include "planner/search/homotopy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "planner/ocp/arm_ocp.h"
#include "planner/ocp/objective.h"
#include "planner/ocp/rests.h"
#include "planner/search/finer_mesh.h"
#include "planner/search/node_moves.h"
#include "planner/search/refinement.h"
#include "planner/trajectory/motion.h"

namespace fjr {
namespace {

// Returns whether solutions of different steps are compared by the objective that would be published. If it does not
// depend on friction, the law only shifts the torque limit, and the sharpest solution is kept. So it is for the largest
// torque, which tightening lowers between the collocation points.
bool compares_published(const Weights& weights) { return sees_friction(weights) && !has_peak(weights); }

// Returns the most iterations of a step, before the factor of the attempts.
int iterations_of_step(const Problem& problem, bool with_rests_scaled, const HomotopySettings& settings) {
  if (with_rests_scaled) return settings.iterations_with_rests;
  if (has_reward(problem.weights)) return settings.iterations_with_reward;
  return sees_friction(problem.weights) ? settings.iterations : settings.iterations_of_shift;
}

// Solves a step by a warm start. Returns whether that gives a solution.
bool solve_step(const std::string& what, const CollocationSetup& setup, Attempts& attempts,
                const ContinuationStrategy& strategy) {
  const ContinuationSettings& s = attempts.settings();
  const double width = setup.smoothing.friction_width;
  const bool scaled = attempts.has_rests() && width <= s.homotopy.rest_width;
  const Collocated from =
      scaled ? with_rests_scaled(attempts.problem(), attempts.solution(), width) : attempts.solution();
  SolveOptions o = strategy.loose_steps ? attempts.loose_options(what) : attempts.warm_options(what);
  const auto within = [&](double iterations) {
    o.max_iterations = static_cast<int>(std::lround(attempts.iteration_factor() * iterations));
    const std::size_t before = attempts.stages().size();
    const bool solved = attempts.warm_from(from, what, setup, o);
    if (attempts.stages().size() > before && attempts.status() == SolveStatus::kIterationLimit) {
      ++attempts.session().fallbacks().friction_level;
    }
    return solved;
  };
  if (within(iterations_of_step(attempts.problem(), scaled, s.homotopy))) return true;
  return attempts.status() == SolveStatus::kIterationLimit && attempts.came_down() && within(s.warm.more_iterations);
}

// Takes a step, in two halves if it fails. Returns whether it was reached.
bool solve_in_halves(const Smoothing& step, int halvings, Attempts& attempts, const ContinuationStrategy& strategy) {
  const Problem& problem = attempts.problem();
  const ContinuationSettings& s = attempts.settings();
  const Collocated& last = attempts.solution();
  const std::string what = fmt::format("{}, friction width {:.2g} rad/s", attempts.label(), step.friction_width);
  CollocationSetup setup = with_finer_mesh(problem, last, last.setup, interval_errors(problem.robot, last.motion),
                                           demand_on_the_way(s), s.mesh);
  const Smoothing from = setup.smoothing;
  setup.smoothing = step;
  if (solve_step(what, setup, attempts, strategy)) return true;
  // If the objective depends on friction, the steps are small already: a step that fails is not halved, and the best
  // solution so far is used. A peak of the torque is excepted, because with a smoothed law it differs too much from
  // that with the exact one.
  if (attempts.stopped() || compares_published(problem.weights)) return false;
  if (halvings == 0) return attempts.anew(what, setup);
  const double sharpest = std::max(step.friction_width, s.homotopy.sharp_width);
  const Smoothing between{std::sqrt(from.friction_width * sharpest),
                          std::sqrt(from.regularisation * step.regularisation)};
  return solve_in_halves(between, halvings - 1, attempts, strategy) &&
         solve_in_halves(step, halvings - 1, attempts, strategy);
}

bool solve_in_halves(const Smoothing& step, Attempts& attempts, const ContinuationStrategy& strategy) {
  return solve_in_halves(step, attempts.settings().homotopy.halvings, attempts, strategy);
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

// Returns the first step with a sharper law, or with the same one and less regularisation.
std::size_t first_step_after(const Smoothing& now, const std::vector<Smoothing>& steps) {
  const auto is_behind = [&](const Smoothing& step) {
    if (step.friction_width != now.friction_width) return step.friction_width > now.friction_width;
    return step.regularisation >= now.regularisation;
  };
  std::size_t next = 1;
  while (next < steps.size() && is_behind(steps[next])) ++next;
  return next;
}

}  // namespace

Homotopy::Homotopy(const Attempts& attempts, const ContinuationStrategy& strategy)
    : next_(first_step_after(attempts.solution().setup.smoothing, strategy.steps)),
      best_(attempts.solution()),
      best_at_(attempts.solutions()),
      least_(published_objective(attempts.problem(), attempts.solution())) {}

void Homotopy::compare(const Attempts& attempts) {
  const double objective = published_objective(attempts.problem(), attempts.solution());
  if (!(objective < least_) && compares_published(attempts.problem().weights)) return;
  least_ = objective;
  best_ = attempts.solution();
  best_at_ = attempts.solutions();
}

// A step often fails because the mesh holds the switching times where they are: then nodes are moved first.
bool Homotopy::reach(const Smoothing& step, Attempts& attempts, const ContinuationStrategy& strategy) {
  if (solve_in_halves(step, attempts, strategy)) return true;
  if (attempts.stopped() || move_jumps(attempts) != ChangeOutcome::kSolved) return false;
  compare(attempts);
  return solve_in_halves(step, attempts, strategy);
}

StepOutcome Homotopy::take_step(Attempts& attempts, const ContinuationStrategy& strategy) {
  const std::vector<Smoothing>& steps = strategy.steps;
  if (next_ >= steps.size()) return StepOutcome::kNoneLeft;
  const Smoothing& step = steps[next_++];
  if (!reach(step, attempts, strategy)) {
    next_ = steps.size();
    return StepOutcome::kFailed;
  }
  compare(attempts);
  const bool nodes_are_moved = step.friction_width == attempts.settings().nodes.first_width;
  if (nodes_are_moved && move_jumps(attempts) == ChangeOutcome::kSolved) compare(attempts);
  return StepOutcome::kTaken;
}

void Homotopy::keep_best(Attempts& attempts) {
  if (best_at_ != attempts.solutions()) attempts.replace(std::move(best_));
}

Completion fade_regularisation(Attempts& attempts, const ContinuationStrategy& strategy) {
  const Problem& problem = attempts.problem();
  if (settles_torque(problem.weights) || !strategy.fades) return Completion::kFinished;
  for (int round = 0; round < attempts.settings().regularisation.rounds; ++round) {
    const RegularisationSettings& s = attempts.settings().regularisation;
    Smoothing step = attempts.solution().setup.smoothing;
    const double weight = make_arm_ocp<Features{}>(problem, step.regularisation).regularisation;
    const double regularisation = weight * squared_torque(attempts.solution().motion);
    const double objective = std::abs(attempts.solution().report.objective - regularisation);
    if (!(regularisation > s.largest * objective)) break;
    step.regularisation *= std::max(s.decrease * s.largest * objective / regularisation, s.largest_change);
    if (!solve_in_halves(step, attempts, strategy)) return attempts.completion();
  }
  return Completion::kFinished;
}

}  // namespace fjr
