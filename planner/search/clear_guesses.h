// Guesses that keep clear of obstacles, where an objective has many minima. From a guess through an obstacle the
// optimiser seldom gets out of it: of the starts of 15 random motions of least effort, copper and energy two of three
// led nowhere.
#pragma once

#include <cstdint>
#include <vector>

#include "planner/ocp/guess.h"
#include "planner/problem/problem.h"
#include "planner/search/guesses.h"

namespace fjr {

// Returns the least clearance [m] of the guess from the obstacles of the task, at a hundred of its postures; infinite
// if there are none.
double clearance_from_obstacles(const Problem& problem, const Guess& guess);

// Returns whether the guess keeps clear, but for a centimetre that the optimiser puts right.
bool keeps_clear(const Problem& problem, const Guess& guess);

// Returns smooth guesses that go by way of other postures: hanging down, one joint after the other. Minima round an
// obstacle differ by these as others do (hanging_guess(), staggered_guess()). usual: one path per segment, for segments
// without such a way. Where no segment has one, there is no guess.
std::vector<Guess> clear_guesses_by_postures(const Problem& problem, double duration, const std::vector<Path>& usual);

// Returns the guess displaced by a smooth random detour of this size [rad], or by less where that does not keep clear;
// the same seed gives the same guess.
Guess displaced_clear_guess(const Problem& problem, const Guess& guess, double size, std::uint64_t seed);

}  // namespace fjr
