#include "planner/search/out_of_reach.h"

#include <algorithm>
#include <cmath>

#include "planner/problem/relaxable.h"
#include "planner/problem/task/task.h"
#include "planner/search/fallbacks.h"
#include "planner/search/fastest.h"
#include "planner/search/search.h"
#include "planner/search/slack.h"

namespace fjr {
namespace {

bool moves_too_fast(const Problem& problem, Search& search, const SearchSettings& settings) {
  const Problem unhurried = fastest_of(problem);  // whatever time it takes
  for (const Relaxable& what : relaxables(unhurried)) {
    if (what.kind != RelaxableKind::kVelocity) continue;
    const Problem slowed = with_slack(unhurried, what, settings.slack);
    const auto slower = search.least_sketch(slowed, what.name, search.guesses(unhurried));
    if (slower && slower->solution().slack > settings.out_of_reach.clearly_slower) return true;
  }
  return false;
}

bool comes_too_early(const Problem& problem, std::size_t via, Search& search, const OutOfReachSettings& settings) {
  const auto there = sketch_to_via(problem, via, search);
  return there && (1 - settings.clearly_early) * there->duration() > *problem.via[via].time;
}

bool any_comes_too_early(const Problem& problem, Search& search, const OutOfReachSettings& settings) {
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    if (problem.via[i].time && comes_too_early(problem, i, search, settings)) return true;
  }
  return false;
}

bool takes_more(const Problem& problem, Search& search, const SearchSettings& settings) {
  const Problem loose = with_larger_time_weight(with_slack_everywhere(problem, settings.slack), settings.slack);
  const auto relaxing =
      search.least_sketch(loose, "all_limits", search.guesses(relaxed(problem, settings.slack.loose)));
  return relaxing && relaxing->solution().slack > settings.out_of_reach.clearly_more;
}

}  // namespace

bool asks_for_more_speed_than_motors_have(const Problem& problem, const OutOfReachSettings& settings) {
  const auto fast = [&](const Joints<double>& dq) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(dq[j]) > settings.much_faster * problem.limits.motor_velocity[j]) return true;
    }
    return false;
  };
  const auto passes_fast = [&](const Via& via) { return via.dq && fast(*via.dq); };
  return (!problem.goal.dq_free && fast(problem.goal.dq)) ||
         std::any_of(problem.via.begin(), problem.via.end(), passes_fast);
}

std::optional<OutOfReach> out_of_reach(const Problem& problem, Session& session) {
  if (!can_be_carried(problem) || !task_rows(problem.robot, problem.task, 0).empty()) return std::nullopt;
  Search search(session, kNoLimit);  // of a few sketches, which each end by their iterations
  const SearchSettings& settings = session.settings();
  if (moves_too_fast(problem, search, settings)) return OutOfReach::kVelocity;
  if (any_comes_too_early(problem, search, settings.out_of_reach)) return OutOfReach::kViaTime;
  if (takes_more(problem, search, settings)) return OutOfReach::kAllLimits;
  return std::nullopt;
}

}  // namespace fjr
