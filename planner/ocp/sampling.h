// Converts the collocation polynomials of a motion to the samples that are published.
#pragma once

#include <Eigen/Core>

#include "planner/collocation/mesh.h"
#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Error of a motor's velocity that the interpolation of its torque between two rows may cause. One such error moves the
// slowest motor by at most 1e-4 rad/s times 0.14 s (J1/B1), 1.4e-5 rad. The errors of hundreds of rows rarely have the
// same sign, so that their sum stays below half a count of the link encoder, 5e-5 rad.
inline constexpr double kRowVelocityError = 1e-4;  // [rad/s]

// States are polynomials on an interval, one row of coefficients per state, lowest degree first, in the fraction of the
// interval. Returns them with positions replaced by the integrals of the velocities, one degree higher, so that both
// are consistent between the collocation points as well. duration: of the interval [s].
Eigen::MatrixXd integrate_positions(const Eigen::MatrixXd& state, double duration);

// Returns whether the integrals meet the positions at the end of the interval: whether the scheme's quadrature is exact
// for polynomials of the velocity's degree. That of the trapezoidal rule is not.
inline bool integrates_velocities(const Eigen::Ref<const Eigen::MatrixXd>& state) { return state.cols() > 3; }

// Returns the motion with positions that are the integrals of its velocities. Those of the trapezoidal rule are not:
// over an interval of length h they miss them by h^2 (a1 - a0) / 12 (a: accelerations at its ends). These errors nearly
// cancel over a segment. Positions are moved on by them, and what is left at the end of the segment is taken off by a
// straight line, so that the motion still meets what is asked there. Motions of other schemes are returned as they are.
Motion with_integrated_positions(Motion motion, const Mesh& mesh);

// Returns samples at multiples of the problem's sample period and at the end. Between them, where linear interpolation
// would miss the torque's impulse, there are pairs of samples kJumpSpacing apart: one pair at each jump of the torque
// (three samples if it falls on a multiple), and as many as fast changes of the friction torque need. tau_m = u +
// tau_fm_nonlinear(dtheta) with the exact law, clamped to the torque limits. velocity_error: allowed interpolation
// error between two samples, as a velocity of the motor [rad/s].
Trajectory sample(const Problem& problem, const Motion& motion, double velocity_error = kRowVelocityError);

}  // namespace fjr
