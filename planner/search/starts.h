// Guesses that the optimiser starts from, in the order in which they are tried.
#pragma once

#include <cstddef>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/search/guesses.h"
#include "planner/search/settings.h"

namespace fjr {

// The first k of them are the same however many there are.
struct Starts {
  std::vector<Guess> guesses;
  // Where the objective depends on friction, Ipopt and our interior-point method often find different minima from one
  // guess. Neither is always better, and ours takes half the time: this many of the first guesses are solved by Ipopt,
  // the others by ours. It cannot restore feasibility, so that tasks are left to Ipopt unless the guesses keep clear.
  std::size_t by_ipopt = 0;
  // Those for the first guesses, which follow paths round obstacles, if these lead nowhere: other motions along the
  // same paths. Of 65 fastest motions past one to three discs two took 36 and 44 % longer without them.
  std::vector<Guess> along_paths_again;
  std::size_t guided = 0;  // number of the first guesses, made for the request; others are displaced at random
  // Number of displaced guesses that are replaced by one near the best motion so far; after them, every second one is.
  std::size_t near_the_best = 0;
  std::size_t always = 0;  // number of guesses that are tried in any case; others are tried until one leads somewhere
  std::size_t enough = 0;  // number of guesses after which no others are tried if all of them led nowhere
};

// Returns how many starts a request has: as many as are asked for, or (0) as its `search` and its objective say.
int starts_to_try(const Problem& problem, int asked, const StartSettings& settings);

// Returns at least `count` starts.
Starts starts_of(const Problem& problem, int count, const StartSettings& settings);

// Returns the first guesses, for solving a neighbouring problem.
std::vector<Guess> first_guesses(const Problem& problem, const StartSettings& settings);

}  // namespace fjr
