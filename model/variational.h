// The arm's variational equation dS/dt = df/dx S + df/dp along a motion, for tick by tick propagation of slopes S of
// the state: by its start, or by parameters p.
#pragma once

#include <Eigen/Core>

#include "model/dynamics.h"
#include "model/parameters.h"

namespace fjr {

using StateMatrix = Eigen::Matrix<double, kStates, kStates>;  // rows and columns in the order of State

// df/dx of dynamics() at x with motor torques held. [1/s and what the states' units make of it]
StateMatrix state_jacobian(const Parameters& p, const State<double>& x, const Joints<double>& torque);

// Of dS/dt = a S + b with both constant over the duration [s]: S afterwards is `start` S + `input` b.
struct Transition {
  StateMatrix start;  // exp(a h)
  StateMatrix input;  // its integral over the duration
};

// By the exponential of [a 1; 0 0] h (Van Loan, Computing integrals involving the matrix exponential, 1978), for where
// friction is steep a h is -80, which no explicit step would bear.
Transition transition_over(const StateMatrix& a, double duration);

}  // namespace fjr
