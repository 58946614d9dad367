// A functional of a whole motion, approximated near a known motion for the optimiser.
#pragma once

#include <array>
#include <vector>

#include "model/dynamics.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// First-order approximation of a functional P near a motion, plus a quadratic term that keeps the next motion close to
// it:
//   int  density + by_state (x - x_near) + by_torque (u - u_near) + 1/2 sum curvature (x - x_near)^2  dt.
// Two motions are compared at equal fractions of their segments. If the other one spends more time there, each
// additional second costs the density, which is P's Hamiltonian.
struct MotionPrice {
  struct Piece {
    double begin, end;                     // [s]
    double density;                        // per second
    std::array<double, kStates> by_state;  // per second and unit of the state
    Joints<double> by_torque;              // of the friction-compensated torque u, per second and N m
  };

  Motion near;
  std::vector<double> durations;  // [s] of its segments
  std::vector<Piece> pieces;      // from its start to its end
  std::array<double, kStates> curvature{};
};

}  // namespace fjr
