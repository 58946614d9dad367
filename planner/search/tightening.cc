#include "planner/search/tightening.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "planner/ocp/margins.h"
#include "planner/ocp/objective.h"
#include "planner/search/creep.h"
#include "planner/search/finer_mesh.h"
#include "planner/search/node_moves.h"
#include "planner/search/refinement.h"

namespace fjr {
namespace {

bool exceeds(const std::vector<PerLimit>& excesses) {
  return std::any_of(excesses.begin(), excesses.end(), [](const PerLimit& here) {
    return std::any_of(here.begin(), here.end(), [](double excess) { return excess > 0; });
  });
}

bool was_solved_loosely(const Collocated& solution) { return solution.report.tolerance > SolveOptions{}.tolerance; }

// Solves with the usual tolerances after a loose solve. If that fails, the last solution stays.
void solve_to_the_end(Attempts& attempts) {
  const std::string what = fmt::format("{}, to the end", attempts.label());
  if (was_solved_loosely(attempts.solution())) {
    attempts.warm(what, CollocationSetup(attempts.solution().setup), attempts.warm_options(what));
  }
}

// Returns the fraction of the base margin that a round keeps.
double part_of_margin_kept(int round, const TighteningSettings& settings) {
  return round < settings.rounds_of_whole_margin ? kCheckedBaseMargin : settings.later_part_of_margin;
}

// Returns the least factor by which a round widens a margin that did not suffice.
double margin_growth(int round, const Collocated& solution, const TighteningSettings& settings) {
  const bool nothing_changed = round > 0 && solution.report.iterations == 0;
  return nothing_changed ? settings.ineffective_growth : settings.growth;
}

// Solves again with margins that are wider by these excesses of each interval.
ChangeOutcome solve_with_wider_margins(const std::vector<PerLimit>& excesses, Attempts& attempts) {
  CollocationSetup setup = attempts.solution().setup;
  const double growth = attempts.settings().tightening.growth;
  if (!widen(setup.margins, excesses, attempts.problem(), growth)) return ChangeOutcome::kNotNeeded;
  const std::string what = fmt::format("{}, margins from the certificate", attempts.label());
  return attempts.warm(what, setup, attempts.warm_options(what)) ? ChangeOutcome::kSolved : ChangeOutcome::kFailed;
}

// The solution with the least peak torque in its rows of all rounds that keep the limits; it need not be the last one.
// Where a motor reverses, a peak that is lowered in one interval can come up in the next.
class LowestPeak {
 public:
  void compare(const Problem& problem, const Collocated& solution) {
    const double objective = published_objective(problem, solution);
    if (!best_ || objective < published_objective(problem, *best_)) best_ = solution;
  }

  void keep(Attempts& attempts) && {
    const Problem& problem = attempts.problem();
    if (!best_ || published_objective(problem, *best_) >= published_objective(problem, attempts.solution())) return;
    attempts.replace(*std::move(best_));
  }

 private:
  std::optional<Collocated> best_;  // empty if no round kept all limits
};

// A setup with finer intervals and wider margins than the solution's.
struct Tighter {
  CollocationSetup setup;
  bool wider, finer;
};

Tighter tighter_setup(const Attempts& attempts, MeshDemand demand, const std::vector<PerLimit>& excess, double growth) {
  const Problem& problem = attempts.problem();
  const Collocated& solution = attempts.solution();
  const ContinuationSettings& s = attempts.settings();
  CollocationSetup setup = solution.setup;
  const bool wider = widen(setup.margins, excess, problem, growth);
  setup = with_finer_mesh(problem, solution, std::move(setup), interval_errors(problem.robot, solution.motion), demand,
                          s.mesh);
  const bool finer = setup.mesh.size() != solution.setup.mesh.size();
  return {std::move(setup), wider, finer};
}

}  // namespace

Completion tighten(Attempts& attempts, const ContinuationStrategy& strategy, int& failures) {
  const Problem& problem = attempts.problem();
  const TighteningSettings& s = attempts.settings().tightening;
  // With wider laws the friction differs from the exact one even where a motor is not yet reversing.
  bool minds_peak =
      problem.weights.peak_torque > 0 && attempts.solution().setup.smoothing.friction_width <= s.sharp_for_peaks;
  LowestPeak lowest;
  for (int round = 0; round < s.rounds && failures < s.failures; ++round) {
    const Collocated& solution = attempts.solution();
    std::vector<PerLimit> excess =
        excesses(problem, solution.setup.mesh, solution.motion, part_of_margin_kept(round, s), solution.slack);
    if (minds_peak && round > 0 && !exceeds(excess)) lowest.compare(problem, solution);
    if (minds_peak) add_excesses_of_peak(excess, problem, solution.motion, solution.peak);
    MeshDemand demand = demand_for_certificate(attempts.settings(), strategy);
    // Where other terms count more, as effort does, margins alone lower the peak.
    demand.lowers_peak = minds_peak && has_peak(problem.weights) && round < s.rounds_of_splitting_for_peak;
    const Tighter next = tighter_setup(attempts, demand, excess, margin_growth(round, solution, s));
    if (!next.wider && !next.finer) {
      if (!was_solved_loosely(attempts.solution())) break;
      solve_to_the_end(attempts);
      if (was_solved_loosely(attempts.solution())) break;
      continue;
    }
    const std::string what =
        fmt::format("{}, {} intervals{}", attempts.label(), next.setup.mesh.size(), next.wider ? " and margins" : "");
    if (attempts.warm_or_anew(what, next.setup, attempts.loose_options(what), strategy)) continue;
    if (attempts.stopped() || !minds_peak) {
      ++failures;
      break;
    }
    minds_peak = false;  // solves once more for limits and mesh alone, without lowering the peak
  }
  if (attempts.stopped()) return Completion::kStopped;
  solve_to_the_end(attempts);
  std::move(lowest).keep(attempts);
  return attempts.completion();
}

Completion tighten_on_moved_nodes(Attempts& attempts, const ContinuationStrategy& strategy, int& failures) {
  move_jumps(attempts);
  for (int round = 0; !attempts.stopped(); ++round) {
    if (tighten(attempts, strategy, failures) == Completion::kStopped) break;
    const bool last = round + 1 >= attempts.settings().nodes.rounds;
    if (last || move_jumps(attempts) != ChangeOutcome::kSolved) return attempts.completion();
  }
  return Completion::kStopped;
}

ChangeOutcome split_by_errors(const std::vector<double>& errors, Attempts& attempts,
                              const ContinuationStrategy& strategy) {
  const Collocated& solution = attempts.solution();
  const ContinuationSettings& s = attempts.settings();
  if (errors.size() != solution.setup.mesh.size()) throw std::logic_error("errors of another mesh");
  MeshDemand demand = demand_for_certificate(s, strategy);
  demand.tolerance = std::min(demand.tolerance, bulk_of(errors, s.mesh.others_of_sum));
  const CollocationSetup setup = with_finer_mesh(attempts.problem(), solution, solution.setup, errors, demand, s.mesh);
  if (setup.mesh.size() == solution.setup.mesh.size()) return ChangeOutcome::kNotNeeded;
  const std::string what = fmt::format("{}, {} intervals", attempts.label(), setup.mesh.size());
  return attempts.warm_or_anew(what, setup, attempts.warm_options(what), strategy) ? ChangeOutcome::kSolved
                                                                                   : ChangeOutcome::kFailed;
}

ChangeOutcome widen_by_checks(const std::vector<LimitCheck>& checks, Attempts& attempts) {
  const Problem& problem = attempts.problem();
  const Collocated& solution = attempts.solution();
  std::vector<PerLimit> more(solution.setup.mesh.size(), PerLimit(limit_scales(problem).size(), 0.0));
  for (const LimitCheck& check : checks) {
    const double limit = check.limit * (1 - kBaseMargin);
    if (check.passed || check.reached <= check.limit) continue;
    const std::size_t at = solution.motion.interval_at(check.time);
    for (std::size_t k = at > 0 ? at - 1 : 0; k < std::min(at + 2, more.size()); ++k) {
      more[k][check.index] = check.reached - limit;
    }
  }
  return solve_with_wider_margins(more, attempts);
}

ChangeOutcome widen_by_rollout(const std::vector<LimitCheck>& checks, Attempts& attempts) {
  PerLimit more(limit_scales(attempts.problem()).size(), 0.0);
  for (const LimitCheck& check : checks) {
    if (!check.passed) more[check.index] = std::max(0.0, check.rollout - check.limit);
  }
  const std::vector<PerLimit> everywhere(attempts.solution().setup.mesh.size(), more);
  return solve_with_wider_margins(everywhere, attempts);
}

ChangeOutcome keep_motors_moving(Attempts& attempts, double shortest_rest) {
  ChangeOutcome done = ChangeOutcome::kNotNeeded;
  CreepSettings settings = attempts.settings().creep;
  settings.shortest_rest = shortest_rest;
  for (int round = 0; round < attempts.settings().tightening.creep_rounds; ++round) {
    CollocationSetup setup = attempts.solution().setup;
    const std::vector<Joints<double>> wanted =
        creep_through_rests(attempts.problem(), attempts.solution().motion, settings);
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
    const std::string what = fmt::format("{}, no unstable rest", attempts.label());
    if (!attempts.warm(what, setup, attempts.warm_options(what))) {
      return done == ChangeOutcome::kSolved ? done : ChangeOutcome::kFailed;
    }
    done = ChangeOutcome::kSolved;
  }
  return done;
}

}  // namespace fjr
