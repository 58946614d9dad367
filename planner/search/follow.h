// From what a start came to on a coarse mesh, to the end.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/search/findings.h"

namespace fjr {

// [s] Coarse meshes of longer motions do not resolve how the springs swing.
inline constexpr double kLongMotion = 8;

// Which solutions are refined to the end.
struct Refining {
  double within;  // relative distance from the best coarse objective that refining may make up
  int most;
};

// Where the objective depends on friction, objectives with smoothed friction do not tell the final order: of seven
// motions the fourth came to 3 % less effort than the first, so several are refined. Every start beyond the usual
// number adds one to them: whatever would be refined without it is refined with it too.
Refining refining(const Weights& weights, int starts);

// Notes a motion that was found on a coarse mesh, and refines and publishes it if it promises something: the best
// certified one is the plan. While nothing is certified, everything is worth it.
void follow(Continuation c, Findings& found, Session& session);

struct Start {
  std::shared_ptr<const Problem> alternative;
  Guess guess;
  std::string label;
  bool by_own_method = false;  // see Continuation
};

struct TriedStart {
  bool led_somewhere = false;    // to a solution, known or new
  bool out_of_patience = false;  // it ended at its limit of iterations
};

// Solves alternatives from these guesses on coarse meshes, and follows what they come to. Each knows what was found
// before, and none what the others come to: so they may be tried at the same time, and how many are makes no
// difference.
std::vector<TriedStart> try_starts(const std::vector<Start>& starts, Findings& found, Session& session);

// The same where more starts follow. What is worth refining waits, and is refined while the next starts are tried: they
// do not depend on it. Fewer and fewer motions are left in a race, so that refining alone makes little use of many
// cores. The caller ends with refine_waiting(). try_starts() refines what was waiting first.
std::vector<TriedStart> try_starts_of_many(const std::vector<Start>& starts, Findings& found, Session& session);
void refine_waiting(Findings& found, Session& session);

}  // namespace fjr
