// Initial guesses for the optimiser.
#pragma once

#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "model/dynamics.h"

namespace fjr {

// A motion as a function of the fraction s in [0, 1] of its duration. It need not satisfy dynamics or constraints.
struct Guess {
  std::string name;
  std::vector<double> durations;                 // [s] of the segments
  std::function<State<double>(double)> state;    // s -> state
  std::function<Joints<double>(double)> torque;  // s -> friction-compensated torque [N m]
  // For a motion that may end anywhere: link angles [rad] at which it ends in a first solve, before the end is
  // optimised.
  std::optional<Joints<double>> first_end = {};
  // [s] Upper bounds on the segments' durations in a first solve, which the next solve drops. Empty: there is no such
  // first solve. Both apply where starts are tried (search/follow.h), and not where an explanation is looked for.
  std::vector<double> first_longest = {};

  double duration() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }
};

}  // namespace fjr
