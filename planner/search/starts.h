// Guesses that the optimiser starts from, in the order in which they are tried.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "planner/problem/problem.h"
#include "planner/search/guesses.h"
#include "planner/search/settings.h"

namespace fjr {

// What a start begins from, and how.
struct StartGuess {
  Guess guess;
  // Another motion along the same path round obstacles, for where the first one leads nowhere. Of 65 fastest motions
  // past one to three discs two took 36 and 44 % longer without them.
  std::optional<Guess> along_path_again{};
  // Where the objective depends on friction, Ipopt and our interior-point method often find different minima from one
  // guess. Neither is always better, and ours takes half the time: the first guesses are solved by Ipopt, the others by
  // ours. It cannot restore feasibility, so that tasks are left to Ipopt unless the guesses keep clear.
  bool by_interior_point = false;
  bool near_the_best = false;  // a guess near the best motion so far takes its place, if there is one
};

// The first k of them are the same however many there are.
struct Starts {
  std::vector<StartGuess> guesses;
  std::size_t always = 0;  // number of guesses that are tried in any case; others are tried until one leads somewhere
  std::size_t enough = 0;  // number of guesses after which no others are tried if all of them led nowhere
};

std::vector<Guess> guesses_of(const Starts& starts);

// Returns how many of the first guesses have another one along the same path.
std::size_t count_along_paths(const Starts& starts);

// Returns how many starts a request has: as many as are asked for, or (0) as its `search` and its objective say.
int starts_to_try(const Problem& problem, int asked, const StartSettings& settings);

// Returns at least `count` starts.
Starts starts_of(const Problem& problem, int count, const StartSettings& settings);

// Returns the first guesses, for solving a neighbouring problem.
std::vector<Guess> first_guesses(const Problem& problem, const StartSettings& settings);

}  // namespace fjr
