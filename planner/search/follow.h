// Follows coarse solutions of starts to certified plans.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/search/findings.h"

namespace fjr {

// Which solutions are refined to the end.
struct Refining {
  double within;  // relative distance from the best coarse objective that refining may make up
  int most;
};

// Returns how many solutions are refined. Every start beyond the usual number adds one, so that more starts never
// displace a motion that would be refined without them.
Refining refining(const Weights& weights, int starts, const FollowSettings& settings);

// Notes a motion that was found on a coarse mesh. Refines and publishes it if it may become the best plan; while
// nothing is certified, every motion is refined.
void follow(Continuation c, Findings& found, Session& session);

// Publishes refined motions, the best first, until one would be no better than the certified plan. They are compared by
// the requested objective, because some may have been solved with another one.
void publish_best(std::vector<Continuation> motions, Findings& found, Session& session);

struct Start {
  std::shared_ptr<const Problem> alternative;
  Guess guess;
  std::string label;
  bool by_interior_point = false;  // see ContinuationOptions
};

// Where a start led.
enum class TriedStart {
  kNowhere,          // to no solution, or its work is ignored (PieceOfWork)
  kOutOfIterations,  // to no solution within its limit of iterations
  kSomewhere,        // to a solution, known or new
};

// Solves alternatives from these guesses on coarse meshes, and follows the solutions. Each start uses what was found
// before, but not the results of the others. So they may run in parallel, and the number of threads makes no difference
// to the results.
std::vector<TriedStart> try_starts(const std::vector<Start>& starts, Findings& found, Session& session);

// Does the same if more starts follow. Motions worth refining wait, and are refined while the next starts, which do not
// depend on them, are solved. (Fewer and fewer motions are left in a race, so refining alone would use few cores.) The
// caller must end with refine_waiting(). try_starts() refines waiting motions first.
std::vector<TriedStart> try_starts_of_many(const std::vector<Start>& starts, Findings& found, Session& session);
void refine_waiting(Findings& found, Session& session);

// Plans the best of these motions again with a penalty on accelerations (with_damping()), for requests that have come
// to no plan in any other way. Without a task the guess is a smooth motion, since the one without penalty may rest on
// the way. The friction law stays as wide as at first: where motors are hardly faster than that, steps to a sharper one
// fail. Does nothing where the penalty does not apply, and keeps only what is certified.
void follow_damped(const std::vector<CoarseMotion>& coarse, Findings& found, Session& session);

}  // namespace fjr
