// Where the optimiser starts.
#pragma once

#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "model/dynamics.h"

namespace fjr {

// A motion as a function of the fraction s in [0, 1] of its duration. It need not satisfy anything.
struct Guess {
  std::string name;
  std::vector<double> durations;                 // [s] of the segments
  std::function<State<double>(double)> state;    // s -> state
  std::function<Joints<double>(double)> torque;  // s -> friction-compensated torque [N m]
  // Of a motion that may end anywhere: where it is to end at first, before its end is optimised. [rad]
  std::optional<Joints<double>> first_end = {};

  double duration() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }
};

}  // namespace fjr
