// Finds the least change of one thing that makes a request feasible.
#pragma once

#include <string>
#include <vector>

#include "planner/search/explain/candidates.h"
#include "planner/search/explain/explanation.h"

namespace fjr {

// Relaxes each of these alone, from these guesses, and keeps the changes that are enough. Returns whether any is. Two
// at a time are relaxed, each with half of the work that is left, so that together they take no more than there is.
bool relax_each(Explanation& e, const std::vector<Candidate>& candidates, const std::vector<Guess>& guesses);

// Relaxes one quantity of both joints together, or else all limits, where no single limit is enough.
void relax_together(Explanation& e, const std::vector<Candidate>& single, const std::vector<Guess>& guesses);

// Drops the limits that a request may not make larger by this fraction of their size.
void keep_within_robot(std::vector<Candidate>& single, double slack);

// Returns whether the changed problem has a motion that takes no longer than it may. It is looked for from the usual
// guesses and from `near`, the motion from which the change was found; near_first: from that one first, because it
// nearly is a solution.
bool is_enough(const Problem& easier, const std::string& what, const Guess& near, bool near_first, Search& search);

}  // namespace fjr
