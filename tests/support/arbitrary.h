// Random inputs of property tests (RapidCheck), with the same seed in every run unless RC_PARAMS says otherwise.
#pragma once

#include <rapidcheck/gtest.h>

#include <cstdlib>

#include "model/dynamics.h"

namespace fjr {

// Set before RapidCheck reads it, that is before the first property runs.
[[maybe_unused]] inline const int kSeeded = setenv("RC_PARAMS", "seed=1", 0);

// Uniform in [low, high]; only inside a property.
inline double between(double low, double high) {
  constexpr int kSteps = 1 << 24;
  // Without resize() the first cases would all lie close to `low`.
  const int step = *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, kSteps + 1));
  return low + (high - low) * step / kSteps;
}

inline Joints<double> pair_between(double low, double high) { return {between(low, high), between(low, high)}; }

// The size of states that plans pass through: any link position, and the limits of robot.yaml on the rest.
inline State<double> any_state() {
  State<double> x;
  x.q = pair_between(-3.2, 3.2);
  x.dq = pair_between(-8, 8);
  for (std::size_t j = 0; j < kJoints; ++j) x.theta[j] = x.q[j] + between(-0.4, 0.4);
  x.dtheta = pair_between(-8, 8);
  return x;
}

}  // namespace fjr
