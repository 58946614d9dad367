// The variational equation of the arm, dS/dt = df/dx S + df/dp along a motion. It propagates the derivatives S of the
// state by the initial state or by parameters p, tick by tick.
#pragma once

#include <Eigen/Core>

#include "model/dynamics.h"
#include "model/parameters.h"

namespace fjr {

using StateMatrix = Eigen::Matrix<double, kStates, kStates>;  // rows and columns in the order of State

// Returns df/dx of dynamics() at x with constant motor torques; each entry has the unit of its row over that of its
// column, per second.
StateMatrix state_jacobian(const Parameters& p, const State<double>& x, const Joints<double>& torque);

// The solution of dS/dt = a S + b with constant a and b over a duration h [s]: afterwards S is `start` S + `input` b.
struct Transition {
  StateMatrix start;  // exp(a h)
  StateMatrix input;  // its integral over the duration
};

// Computes the transition by the exponential of [a 1; 0 0] h (Van Loan, Computing integrals involving the matrix
// exponential, 1978), because with steep friction a h is -80, for which an explicit step would be unstable.
Transition transition_over(const StateMatrix& a, double duration);

}  // namespace fjr
