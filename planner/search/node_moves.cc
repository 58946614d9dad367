#include "planner/search/node_moves.h"

#include <fmt/format.h>

#include <string>

#include "planner/analysis/node_times.h"

namespace fjr {

ChangeOutcome move_jumps(Attempts& attempts) {
  // A pause is a matter of time: moved nodes would leave it, and it would bound other intervals.
  if (!attempts.has_rests() || attempts.problem().variation.pause) return ChangeOutcome::kNotNeeded;
  const NodeTimes times = node_times(attempts.problem(), attempts.solution());
  if (times.spread <= times.allowed || times.jumps.empty()) return ChangeOutcome::kNotNeeded;
  const std::string what = fmt::format("{}, {} nodes moved", attempts.label(), times.jumps.size());
  SolveOptions o = attempts.warm_options(what);
  const auto within = [&](int iterations) {
    o.max_iterations = iterations;
    return attempts.moving_nodes(what, times.jumps, o);
  };
  const ContinuationSettings& s = attempts.settings();
  if (within(s.nodes.iterations)) return ChangeOutcome::kSolved;
  // With a sharper law, attempts whose objective still falls at the limit of iterations seldom converge later.
  const bool smooth = attempts.solution().setup.smoothing.friction_width >= s.nodes.first_width;
  const bool goes_on = smooth && attempts.status() == SolveStatus::kIterationLimit && attempts.came_down();
  return goes_on && within(s.warm.more_iterations) ? ChangeOutcome::kSolved : ChangeOutcome::kFailed;
}

}  // namespace fjr
