#include "planner/search/out_of_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "planner/problem/relaxable.h"
#include "planner/problem/task/task.h"
#include "planner/search/continuation.h"
#include "planner/search/fallbacks.h"
#include "planner/search/fastest.h"
#include "planner/search/slack.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

// Fraction of the least time by which a via point comes too early: smoothed motions are some per cent slower.
constexpr double kClearlyEarly = 0.05;
constexpr double kClearlyMore = 0.5;    // fraction by which all limits would have to be larger
constexpr double kClearlySlower = 0.5;  // fraction by which a velocity alone would have to be smaller
constexpr double kRelaxedAtFirst = 3;   // fraction by which limits are relaxed for a duration to start from
constexpr double kUsualDuration = 1;    // [s] motions that take longer are begun with as many intervals as one of this
constexpr std::size_t kGuessesProbed = 2;
constexpr int kMostIterationsOfProbe = 250;  // of one solve: those that lead somewhere took up to 190

// The least objective that is met from the first guesses, on coarse meshes.
std::optional<Continuation> least_met(const Problem& problem, const std::vector<Guess>& guesses,
                                      const std::string& label, Session& session) {
  const auto kept = std::make_shared<const Problem>(problem);
  std::optional<Continuation> best;
  for (std::size_t i = 0; i < std::min(kGuessesProbed, guesses.size()) && !session.interrupted(); ++i) {
    Continuation c(kept, session, label);
    c.mesh_factor = std::min(1.0, kUsualDuration / guesses[i].duration());
    if (c.begin(guesses[i], kMostIterationsOfProbe) != StartOutcome::kNew) continue;
    if (!best || c.solution().report.objective < best->solution().report.objective) best = std::move(c);
  }
  return best;
}

bool moves_too_fast(const Problem& problem, Session& session) {
  const Problem unhurried = fastest_of(problem);  // whatever time it takes
  for (const Relaxable& what : relaxables(unhurried)) {
    if (what.kind != RelaxableKind::kVelocity || session.interrupted()) continue;
    const auto slower = least_met(with_slack(unhurried, what), first_guesses(unhurried),
                                  fmt::format("how far {} is out of reach", what.name), session);
    if (slower && slower->solution().slack > kClearlySlower) return true;
  }
  return false;
}

bool comes_too_early(const Problem& problem, std::size_t via, Session& session) {
  const Problem fastest = fastest_to_via(problem, via);
  const auto there = least_met(fastest, first_guesses(fastest), fmt::format("fastest to via[{}]", via), session);
  return there && (1 - kClearlyEarly) * there->duration() > *problem.via[via].time;
}

bool any_comes_too_early(const Problem& problem, Session& session) {
  for (std::size_t i = 0; i < problem.via.size(); ++i) {
    if (problem.via[i].time && comes_too_early(problem, i, session)) return true;
  }
  return false;
}

bool takes_more(const Problem& problem, Session& session) {
  if (!can_be_carried(problem)) return false;
  const auto relaxing = least_met(hurried(with_slack_everywhere(problem)),
                                  first_guesses(relaxed(problem, kRelaxedAtFirst)), "how far out of reach", session);
  return relaxing && relaxing->solution().slack > kClearlyMore;
}

}  // namespace

std::optional<OutOfReach> out_of_reach(const Problem& problem, Session& session) {
  if (!task_rows(problem.robot, problem.task, 0).empty()) return std::nullopt;
  if (moves_too_fast(problem, session)) return OutOfReach::kVelocity;
  if (any_comes_too_early(problem, session)) return OutOfReach::kViaTime;
  if (takes_more(problem, session)) return OutOfReach::kAllLimits;
  return std::nullopt;
}

}  // namespace fjr
