// Simulates an arm under the torques of a log.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "model/dynamics.h"
#include "planner/identify/executed_motion.h"

namespace fjr {

// Consecutive rows of a motion that are simulated from an initial state of their own.
struct ReplayedPiece {
  std::size_t motion;        // index of the motion
  std::size_t first, count;  // rows
  State<double> begins;      // guess of the initial state, fitted to its first readings
};

// Divides a motion into pieces of at most kPiece, so that model errors do not accumulate for long. Rows are left out
// where a motor stays at velocities at which its friction falls with speed (motor 2 at rest): there errors grow at a
// rate of 365/s, so that the motion of the motor cannot be predicted. Pieces that are too short are left out as well.
inline constexpr double kPiece = 2;  // [s]
std::vector<ReplayedPiece> pieces_of(const Parameters& robot, const ExecutedMotion& motion, std::size_t index);

// Returns the simulated positions [rad] at the rows of a piece that begins in the state `start`: q1, q2, theta1, theta2
// of the first row, of the second, ... Returns nothing if the parameters are impossible or the integration fails.
//
// The log contains the commanded torque of each tick, including feedback. Given these torques, the motion of an arm
// without disturbances is determined, and the quantisation of its encoders is the only random error.
std::optional<Eigen::VectorXd> replayed(const Parameters& robot, const ExecutedMotion& motion,
                                        const ReplayedPiece& piece, const State<double>& start);

// Relative step of a parameter for differences. It is a few standard errors after three motions, and its effect is a
// thousand times the error of the integration.
inline constexpr double kSlopeStep = 2e-5;

// Returns the standard deviation [rad] of each encoder's quantisation error, which is uniform within a count, in the
// order q1, q2, theta1, theta2.
Eigen::Vector4d count_deviation(const Parameters& robot);

}  // namespace fjr
