#include "planner/search/finer_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "model/friction.h"
#include "planner/ocp/margins.h"
#include "planner/problem/task/task.h"
#include "planner/search/refinement.h"

namespace fjr {
namespace {

bool is_torque(std::size_t limit) { return limit < kLimits && kLimitNames[limit].is_of(Torque::info); }

// Excesses [N m] over the peak torque that the objective minimises.
class OverPeak {
 public:
  OverPeak(const Problem& problem, const Collocated& solution, const MeshDemand& demand, const MeshSettings& settings)
      : problem_(problem), solution_(solution), shortest_(settings.shortest_interval_for_peak) {
    if (!demand.lowers_peak) return;
    excess_.assign(solution.setup.mesh.size(), PerLimit(limit_scales(problem).size(), 0.0));
    add_excesses_of_peak(excess_, problem, solution.motion, solution.peak);
  }

  // Returns the excess in interval k with its margin [N m] for torque limit i, as a fraction of the peak; 0 if there is
  // none or the interval is too short to be split for it.
  double fraction(std::size_t k, std::size_t i, double margin) const {
    if (excess_.empty() || solution_.motion.intervals[k].duration <= shortest_) return 0;
    return (excess_[k][i] + margin) / solution_.peak[kLimitNames[i].j()];
  }

  // Returns the end of the interval, 0 or 1, at which a motor begins to move or comes to rest above the peak.
  std::optional<double> end_at_rest(std::size_t k, std::size_t i) const {
    if (excess_.empty() || excess_[k][i] == 0) return std::nullopt;
    if (k == 0 && problem_.start_at_rest) return 0;
    if (k + 1 == excess_.size() && problem_.goal.at_rest) return 1;
    return std::nullopt;
  }

 private:
  const Problem& problem_;
  const Collocated& solution_;
  double shortest_;
  std::vector<PerLimit> excess_;  // empty: peaks are not lowered
};

// Raises the errors [rad] of intervals that exceed limits by much, so that they are split. Returns where friction steps
// in intervals that exceed a torque limit because of it: there the interval is cut instead.
Cuts raise_for_excesses(std::vector<double>& errors, const Problem& problem, const Collocated& solution,
                        const std::vector<PerLimit>& margins, const MeshDemand& demand, const MeshSettings& settings) {
  const double split = settings.error_when_splitting * demand.tolerance,
               quartered = std::pow(2, solution.setup.scheme.order + 2) * demand.tolerance;
  const double worth = demand.excess_worth_splitting;
  const std::vector<PerLimit> excess =
      excesses(problem, solution.setup.mesh, solution.motion, kCheckedBaseMargin, solution.slack);
  const PerLimit scales = limit_scales(problem);
  const OverPeak over_peak(problem, solution, demand, settings);
  Cuts steps(errors.size());
  for (std::size_t k = 0; k < errors.size(); ++k) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
      const double margin = margins.empty() ? 0 : margins[k][i];
      double fraction = (excess[k][i] + margin) / scales[i];  // zero without a limit
      if (is_torque(i)) fraction = std::max(fraction, over_peak.fraction(k, i, margin));
      if (fraction <= worth) continue;
      if (is_torque(i) && fraction > settings.excess_worth_splitting) {
        auto step = reversal_in(solution.motion, k, kLimitNames[i].j());
        if (!step) step = over_peak.end_at_rest(k, i);
        if (step) {
          steps[k].push_back(*step);
          continue;
        }
      }
      errors[k] = std::max(errors[k], split);
      if (fraction > settings.excess_worth_quartering * worth) errors[k] = std::max(errors[k], quartered);
    }
  }
  return steps;
}

// Raises the errors [rad] of intervals that misjudge the objective, so that they are split.
void raise_for_cost(std::vector<double>& errors, const Problem& problem, const Collocated& solution,
                    double friction_width, const MeshDemand& demand, const MeshSettings& settings) {
  if (!sees_friction(problem.weights)) return;
  Joints<FrictionLaw> law{FrictionLaw::of(problem.robot, 0), FrictionLaw::of(problem.robot, 1)};
  for (FrictionLaw& l : law) l = l.smoothed(friction_width);
  const std::vector<double> cost = cost_errors(problem, law, solution.setup.scheme, solution.motion);
  const double allowed = settings.cost_tolerance * std::abs(solution.report.objective);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (cost[k] > allowed) errors[k] = std::max(errors[k], settings.error_when_splitting * demand.tolerance);
  }
}

// Returns how many intervals a mesh may have. The more rows an interval has, the more memory it takes.
std::size_t most_intervals(const Problem& problem, const MeshSettings& settings) {
  const double rows = static_cast<double>(count_of_rows(problem.task));
  const double without_task = settings.rows_without_task;
  return static_cast<std::size_t>(static_cast<double>(settings.most_intervals) * without_task / (without_task + rows));
}

// Returns into how many pieces each interval is split. If that gives more than `most` intervals, only the worst are
// split.
std::vector<int> affordable_pieces(const Collocated& solution, const std::vector<double>& errors, double tolerance,
                                   std::size_t most, const MeshSettings& settings) {
  const auto count = [](const std::vector<int>& pieces) {
    return static_cast<std::size_t>(std::accumulate(pieces.begin(), pieces.end(), 0));
  };
  std::vector<int> pieces;
  do {
    pieces = pieces_wanted(solution.motion, errors, tolerance, solution.setup.scheme.order, settings.shortest_interval);
    tolerance *= settings.looser;
  } while (count(pieces) > std::max(most, errors.size()));
  return pieces;
}

// Returns the setup with its mesh split. Its margins are dropped in split intervals, which may not need them.
CollocationSetup split_setup(CollocationSetup setup, const Cuts& cuts) {
  std::vector<int> pieces;
  for (const std::vector<double>& of_interval : cuts) pieces.push_back(static_cast<int>(of_interval.size()) + 1);
  setup.mesh = split(setup.mesh, cuts);
  for (std::size_t k = 0; k < setup.margins.size(); ++k) {
    if (pieces[k] > 1) std::fill(setup.margins[k].begin(), setup.margins[k].end(), 0.0);
  }
  setup.margins = inherited(setup.margins, pieces);
  setup.creep = inherited(setup.creep, pieces);
  return setup;
}

// Returns for each segment the time [s] between the given velocities before and after it: of start, goal, and the via
// points that prescribe them. segments: their durations [s].
std::vector<double> times_between_velocities(const Problem& problem, const std::vector<double>& segments) {
  std::vector<double> durations;
  for (std::size_t first = 0, s = 0; s < segments.size(); ++s) {
    const bool last = s + 1 == segments.size();
    if (!last && !problem.via[s].dq) continue;
    const auto begin = segments.begin();
    const double duration =
        std::accumulate(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(s) + 1, 0.0);
    durations.resize(s + 1, duration);
    first = s + 1;
  }
  return durations;
}

// Raises the errors [rad] of intervals between velocities that soon follow each other, by as much as less is allowed
// there.
void raise_for_short_times(std::vector<double>& errors, const Problem& problem, const Collocated& solution,
                           const MeshSettings& settings) {
  const std::vector<double> durations = times_between_velocities(problem, solution.durations);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double duration = durations[static_cast<std::size_t>(solution.setup.mesh.intervals[k].segment)];
    const double short_by = duration / settings.full_tolerance_from;
    errors[k] /= std::clamp(short_by * short_by * short_by, settings.least_part_of_tolerance, 1.0);
  }
}

}  // namespace

MeshDemand demand_on_the_way(const ContinuationSettings& settings) {
  return {settings.homotopy.mesh_tolerance, settings.mesh.excess_worth_splitting};
}

MeshDemand demand_for_certificate(const ContinuationSettings& settings, const ContinuationStrategy& strategy) {
  return {strategy.mesh * settings.mesh.tolerance,
          strategy.worth_splitting.value_or(settings.mesh.excess_worth_splitting)};
}

CollocationSetup with_finer_mesh(const Problem& problem, const Collocated& solution, CollocationSetup setup,
                                 std::vector<double> errors, const MeshDemand& demand, const MeshSettings& settings) {
  raise_for_short_times(errors, problem, solution, settings);
  const Cuts steps = raise_for_excesses(errors, problem, solution, setup.margins, demand, settings);
  raise_for_cost(errors, problem, solution, setup.smoothing.friction_width, demand, settings);
  Cuts cuts =
      equal_cuts(affordable_pieces(solution, errors, demand.tolerance, most_intervals(problem, settings), settings));
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const double shortest = settings.shortest_interval / solution.motion.intervals[k].duration;
    for (const double step : steps[k]) cut_around(cuts[k], step, shortest);
  }
  return split_setup(std::move(setup), cuts);
}

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

}  // namespace fjr
