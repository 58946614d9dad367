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

// Fraction of the least time by which a via point comes too early: smoothed motions are some per cent slower.
constexpr double kClearlyEarly = 0.05;
constexpr double kClearlyMore = 0.5;    // fraction by which all limits would have to be larger
constexpr double kClearlySlower = 0.5;  // fraction by which a velocity alone would have to be smaller
bool moves_too_fast(const Problem& problem, Search& search) {
  const Problem unhurried = fastest_of(problem);  // whatever time it takes
  for (const Relaxable& what : relaxables(unhurried)) {
    if (what.kind != RelaxableKind::kVelocity) continue;
    const auto slower = search.least_sketch(with_slack(unhurried, what), what.name, search.guesses(unhurried));
    if (slower && slower->solution().slack > kClearlySlower) return true;
  }
  return false;
}

bool comes_too_early(const Problem& problem, std::size_t via, Search& search) {
  const auto there = sketch_to_via(problem, via, search);
  return there && (1 - kClearlyEarly) * there->duration() > *problem.via[via].time;
}

bool any_comes_too_early(const Problem& problem, Search& search) {
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    if (problem.via[i].time && comes_too_early(problem, i, search)) return true;
  }
  return false;
}

bool takes_more(const Problem& problem, Search& search) {
  const auto relaxing = search.least_sketch(with_larger_time_weight(with_slack_everywhere(problem)), "all_limits",
                                            search.guesses(relaxed(problem, kLoose)));
  return relaxing && relaxing->solution().slack > kClearlyMore;
}

}  // namespace

bool asks_for_more_speed_than_motors_have(const Problem& problem) {
  constexpr double kMuchFaster = 2;  // times the motor's limit
  const auto fast = [&](const Joints<double>& dq) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(dq[j]) > kMuchFaster * problem.limits.motor_velocity[j]) return true;
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
  if (moves_too_fast(problem, search)) return OutOfReach::kVelocity;
  if (any_comes_too_early(problem, search)) return OutOfReach::kViaTime;
  if (takes_more(problem, search)) return OutOfReach::kAllLimits;
  return std::nullopt;
}

}  // namespace fjr
