// Torques that hold the arm still, without any optimisation.
#pragma once

#include "planner/problem/problem.h"

namespace fjr {

// The most that gravity takes of each joint anywhere on the straight lines in joint space from the start through the
// via points to the goal. A slow motion along them needs at least this much.
struct Carrying {
  Limits needed = Limits::all(0);    // magnitudes of torque and spring deflection; zero for all others
  Joints<Joints<double>> posture{};  // [rad] link angles at which each joint needs most
};
Carrying carrying(const Problem& problem);

}  // namespace fjr
