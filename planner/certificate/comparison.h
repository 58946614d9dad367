// Compares a rollout with the plan at every row and at instants between the rows.
#pragma once

#include <string>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/certificate/rollout.h"

namespace fjr {

struct Comparison {
  RolloutErrors errors;
  Joints<double> link_velocity_error{};  // [rad/s] rollout against the dq columns, largest over the instants
  double time_of_max_link_velocity = 0;
  Joints<double> motor_velocity_error{};        // [rad/s] likewise, against the dtheta columns
  Joints<double> time_of_max_motor_velocity{};  // [s]
  Joints<double> feedback_torque{};             // [N m] largest
  Joints<double> time_of_feedback{};            // [s]
  Limits peaks = Limits::all(0);  // largest magnitudes reached, with the commanded torque: plan and feedback
  std::vector<Event> events;      // of the rollout
  State<double> final{};          // where it ended
};

// Returns the times [s] of all rows after the first, and instants between them at most 0.25 ms apart.
std::vector<double> comparison_instants(const Trajectory& trajectory);

// Changes of the torque's slope [N m/s] up to which error control alone handles a corner. Stopping at more of them
// costs nothing; leaving more (20) moved motors by up to 7e-7 rad.
inline constexpr double kCorner = 0.1;

// A part of a rollout, which begins at the end of the one before.
struct Piece {
  double to;  // [s]
  Drive drive;
  bool afresh;  // begins in the plan's own state, not in the one reached
};

// Returns the pieces of an open-loop rollout. Within `stretches` the resting motor has its feedback and dither; at
// their ends the run begins again in the plan's own state.
std::vector<Piece> open_loop_pieces(const Parameters& robot, const Trajectory& trajectory,
                                    const std::vector<Stretch>& stretches);

// Rolls the trajectory out from its first row in these pieces, of which the last ends with the trajectory. corner:
// stops at larger changes of the torque's slope [N m/s].
Comparison compare(Rollout& rollout, const Parameters& robot, const Trajectory& trajectory,
                   const std::vector<Piece>& pieces, const std::vector<double>& instants, double corner = kCorner);

// Does the same in one piece.
Comparison compare(Rollout& rollout, const Parameters& robot, const Trajectory& trajectory, const Drive& drive,
                   const std::vector<double>& instants, double corner = kCorner);

}  // namespace fjr
