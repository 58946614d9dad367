#include "planner/search/follow.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace fjr {
namespace {

constexpr int kLeastPatience = 100;  // iterations of a start

// Whether the candidate that was found last is worth refining, beside those before it.
bool last_promises(const Findings& found) {
  std::vector<CoarseSolution> best_first;
  for (const CoarseMotion& c : found.candidates) best_first.push_back(c.coarse);
  std::stable_sort(best_first.begin(), best_first.end(),
                   [](const CoarseSolution& a, const CoarseSolution& b) { return a.objective < b.objective; });
  const Weights& weights = found.asked.weights;
  const std::vector<bool> worth = worth_refining(best_first, refining(weights, 0).within,
                                                 [&](int starts) { return refining(weights, starts).most; });
  const int last = found.candidates.back().coarse.start;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    if (best_first[i].start == last) return worth[i];
  }
  return true;
}

// Motions of many seconds are refined to thousands of intervals. How long the fastest takes is known to a per cent
// before; where it may not take nearly as long, that is enough to say so.
bool far_too_long(const Continuation& c, const Problem& asked) {
  constexpr double kFar = 1.15;  // times the longest duration
  const double duration = c.duration();
  return only_time(asked.weights) && duration > kLongMotion && duration > kFar * asked.duration.max;
}

// Where a speed limit is all that keeps a long motion, springs may swing along it, and a motor that has time to spare
// may tremble, at no cost in time, and more finely than any mesh or rows of many seconds could hold. Small weights of
// other terms still them; what the plan is judged by is the objective that was asked for.
struct Calming {
  double link_acceleration;  // [s^4/rad^2] stills the springs; a motion of 30 s takes 0.2 % longer for it
  double link_jerk;          // [s^6/rad^2] stills the motors too; ten times as much left more error in one of 75 s
};
// The second where the first is not certified: with it a motion of 30 s near the upright was less exact.
constexpr Calming kCalming[] = {{0.01, 0}, {0.01, 1e-6}};

Continuation calmed(const Continuation& c, const Calming& calming, int patience, Session& session) {
  Problem problem = *c.problem();
  problem.weights.link_acceleration = calming.link_acceleration;
  problem.weights.link_jerk = calming.link_jerk;
  Continuation calmer(std::make_shared<const Problem>(std::move(problem)), session, c.label() + ", calm");
  calmer.start = c.start;
  const Collocated& hasty = c.solution();
  const Guess guess = guess_from(hasty.motion, hasty.durations, c.duration());
  return calmer.begin(guess, patience) == StartOutcome::kNew ? calmer : c;
}

// True when it was certified, even if it takes too long.
bool refine(Continuation c, Findings& found, Session& session) {
  const Timed timed(session, "finish");
  if (found.certified()) c.to_beat = found.best->objective / found.scale;
  if (!c.refine()) return false;
  PublishResult published = publish(c, found.asked, session);
  const bool certified = published.certified();
  found.keep(c, std::move(published));
  return certified;
}

}  // namespace

Refining refining(const Weights& weights, int starts) {
  const int more = std::max(0, starts - starts_worth_trying(weights));
  return sees_friction(weights) ? Refining{0.05, 5 + more} : Refining{0.02, 3 + more};
}

void follow(Continuation c, Findings& found, Session& session) {
  const Collocated& coarse = c.solution();
  found.candidates.push_back({c.problem(), {coarse.report.objective, c.start}, coarse.motion, coarse.durations});
  if ((found.certified() && !last_promises(found)) || session.interrupted()) return;
  if (far_too_long(c, found.asked)) {
    found.note_fastest(c, false);
    return;
  }
  session.enter(Phase::kRefining);
  if (!only_time(c.problem()->weights) || c.duration() < kLongMotion) {
    refine(std::move(c), found, session);
  } else {
    for (const Calming& calming : kCalming) {
      if (session.interrupted() || refine(calmed(c, calming, found.patience, session), found, session)) break;
    }
  }
  ++found.refined;
}

bool try_start(const std::shared_ptr<const Problem>& alternative, const Guess& guess, const std::string& label,
               Findings& found, Session& session) {
  Continuation c(alternative, session, label);
  const StartOutcome outcome = c.begin(guess, found.patience, found.minima);
  c.start = ++found.starts;
  if (outcome == StartOutcome::kKnown) return true;
  if (outcome == StartOutcome::kNoSolution) {
    if (c.status() == SolveStatus::kInfeasible) found.a_start_was_infeasible = true;
    if (!c.obstacle().empty()) found.obstacle = "; in the last attempt " + c.obstacle();
    return false;
  }
  // What is much harder than what was found already is given up early; counted in iterations, so that it is the same
  // every time.
  const SolverStage& first = c.stages().front();
  found.patience = std::min(found.patience, std::max(kLeastPatience, 2 * first.iterations));
  found.minima.push_back(first.objective);
  follow(std::move(c), found, session);
  return true;
}

}  // namespace fjr
