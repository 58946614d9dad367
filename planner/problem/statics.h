// What holding the arm still takes, without any optimisation.
#pragma once

#include "planner/problem/problem.h"

namespace fjr {

// The most that gravity takes of each joint anywhere on the straight lines in the joint angles from the start through
// the via points to the goal: what a motion that dawdles along them cannot do without.
struct Carrying {
  Joints<double> torque{};           // [N m]
  Joints<double> deflection{};       // [rad]
  Joints<Joints<double>> posture{};  // [rad] of each joint's largest, the link angles

  // Of a limited quantity, in its unit; 0 where carrying takes none.
  double of(const QuantityInfo& quantity, std::size_t joint) const;
};
Carrying carrying(const Problem& problem);

}  // namespace fjr
