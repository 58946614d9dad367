// Where the optimiser starts.
#pragma once

#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "planner/collocation/motion.h"
#include "planner/problem/problem.h"

namespace fjr {

// A motion as a function of the share s in [0, 1] of its duration. It need not satisfy anything.
struct Guess {
  std::string name;
  std::vector<double> durations;               // [s] of the segments
  std::function<State<double>(double)> state;  // s -> state
  std::function<Pair<double>(double)> torque;  // s -> friction-compensated torque [N m]

  double duration() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }
};

// q on straight lines through start, via points and goal, theta in static equilibrium, at rest, zero torque.
Guess straight_guess(const Problem& problem, double duration);

// Minimum-jerk q between the same points, everything else by flatness (motor friction apart, u needs none).
Guess minimum_jerk_guess(const Problem& problem, double duration);

// Link angles one after the other [rad], with straight lines between.
using Way = std::vector<Pair<double>>;

// Along one way per segment, corners rounded, theta in static equilibrium, at rest, zero torque.
Guess way_guess(const Problem& problem, double duration, const std::vector<Way>& ways);

// The ways of the segments on which the tip keeps to the task's line or arc, where it has one.
std::vector<Way> ways_along_tip_path(const Problem& problem);

// The straight guess, displaced by a smooth random detour of the given size [rad]; the same seed gives the same guess.
Guess displaced_guess(const Problem& problem, double duration, double size, std::uint64_t seed);

// The guess in what remains of its time when it waits for these shares of it first, and at last.
Guess waiting_guess(Guess guess, double first, double last);

// A motion that was solved before, with segments of these durations, stretched to `duration`.
Guess guess_from(Motion motion, const std::vector<double>& durations, double duration);

// A duration to start from, clamped to the problem's bounds: the fixed one, or what the drives' torque and velocity
// limits allow a rigid arm, roughly.
double duration_guess(const Problem& problem);

}  // namespace fjr
