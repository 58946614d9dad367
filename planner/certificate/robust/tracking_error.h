// What the uncertainty of the arm's parameters is expected to make of its links' tracking, and how that depends on the
// motion.
#pragma once

#include <vector>

#include "planner/certificate/robust/sensitivities.h"
#include "planner/problem/motion_price.h"

namespace fjr {

// E int |q - q_plan|^2 dt [rad^2 s] over the arms that the uncertainty leaves possible, in the executor's loop, to
// first order: int tr(S_q C S_q^T) dt, with S_q the links' rows of the sensitivities and C the covariance.
double expected_tracking_error(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty);

// That, and its derivatives by the motion.
struct TrackingGradient {
  double value = 0;                        // [rad^2 s]
  std::vector<MotionPrice::Piece> pieces;  // from the first row to the last
};

// [rad/s] to both sides of a motor's velocity, over which its friction is differentiated. The law's steps are narrower
// than 1e-3 rad/s: by its slope within a step the search would move motors that rest far, and gain nothing.
inline constexpr double kFrictionReach = 0.2;

// By the adjoint recursion of the sensitivities, backwards from the last tick. With L = dP/dS,
//   dP = int sum_i L_i^T d(df/dx S_i + df/dp_i) dt
// where states and compensated torques change at their places of the motion, and L^T dS/dt + tr(S_q C S_q^T) a second
// where a place takes longer. The integrand is differentiated numerically; a motor's torque goes with its velocity by
// tau_m = u + tau_fm_nonlinear. Of a motion that becomes longer the ticks are taken for as many more. The adjoint
// method: Bryson & Ho, Applied Optimal Control (1975), ch. 2.
TrackingGradient tracking_gradient(const Parameters& robot, const Trajectory& trajectory,
                                   const Uncertainty& uncertainty, double friction_reach = kFrictionReach);

}  // namespace fjr
