// Expected tracking error of the links because of uncertain parameters, and its derivatives by the motion.
#pragma once

#include <vector>

#include "planner/certificate/robust/sensitivities.h"
#include "planner/problem/motion_price.h"

namespace fjr {

// Returns E int |q - q_plan|^2 dt [rad^2 s] over the possible arms in the executor's loop, to first order: int tr(S_q C
// S_q^T) dt, with S_q the links' rows of the sensitivities and C the covariance.
double expected_tracking_error(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty);

// The expected tracking error and its derivatives by the motion.
struct TrackingGradient {
  double value = 0;                        // [rad^2 s]
  std::vector<MotionPrice::Piece> pieces;  // from the first row to the last
};

// [rad/s] Distance on both sides of a motor's velocity over which its friction is differentiated. The steps of the law
// are narrower than 1e-3 rad/s: with its slope within a step, the search would move resting motors far and gain
// nothing.
inline constexpr double kFrictionReach = 0.2;

// Returns the gradient, by the adjoint recursion of the sensitivities, backwards from the last tick. With L = dP/dS,
//   dP = int sum_i L_i^T d(df/dx S_i + df/dp_i) dt
// for changes of states and compensated torques at fixed places of the motion, and L^T dS/dt + tr(S_q C S_q^T) per
// second if a place takes longer. The integrand is differentiated numerically; a motor's torque changes with its
// velocity by tau_m = u + tau_fm_nonlinear. A motion that becomes longer is assumed to have proportionally more ticks.
// The adjoint method: Bryson & Ho, Applied Optimal Control (1975), ch. 2.
TrackingGradient tracking_gradient(const Parameters& robot, const Trajectory& trajectory,
                                   const Uncertainty& uncertainty, double friction_reach = kFrictionReach);

}  // namespace fjr
