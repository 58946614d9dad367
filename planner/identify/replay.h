// An arm under the torques of a log.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "model/dynamics.h"
#include "planner/identify/executed_motion.h"

namespace fjr {

// Rows of a motion that are rolled out from a start of their own.
struct ReplayedPiece {
  std::size_t motion;        // which one
  std::size_t first, count;  // rows
  State<double> begins;      // about where: what the readings of its first rows are nearest to
};

// A motion in pieces of kPiece or less, so that little adds up of what the model has not. Left out is where a motor
// parks in velocities at which its friction falls (motor 2's, at rest): there errors grow by 365/s, and nobody can say
// where the motor goes. Too short pieces are left out, too.
inline constexpr double kPiece = 2;  // [s]
std::vector<ReplayedPiece> pieces_of(const Parameters& robot, const ExecutedMotion& motion, std::size_t index);

// Where the encoders are at the rows of a piece that begins in a state [rad]: q1, q2, theta1, theta2 of the first, of
// the second, ... Nothing where there can be no such arm, or the integration breaks down.
//
// The torque of each tick is in the log, whatever made the executor command it. Given it, an arm without other
// disturbances moves in one way alone, and the counts of its encoders are all that is left to chance.
std::optional<Eigen::VectorXd> replayed(const Parameters& robot, const ExecutedMotion& motion,
                                        const ReplayedPiece& piece, const State<double>& start);

// Of a parameter, by which it is moved to differentiate positions by it: a few standard errors of three motions, and a
// thousand times what the integration errs by.
inline constexpr double kSlopeStep = 2e-5;

// Counts' standard deviation of each encoder, in that order: uniform within a count. [rad]
Eigen::Vector4d count_deviation(const Parameters& robot);

}  // namespace fjr
