// What holding the arm still takes, without any optimisation.
#pragma once

#include "planner/problem/problem.h"

namespace fjr {

// The most that gravity takes of each joint anywhere on the straight lines in the joint angles from the start through
// the via points to the goal: what a motion that dawdles along them cannot do without.
struct Carrying {
  Limits needed = Limits::all(0);    // magnitudes: of torque and spring deflection, zero of all others
  Joints<Joints<double>> posture{};  // [rad] of each joint's largest, the link angles
};
Carrying carrying(const Problem& problem);

}  // namespace fjr
