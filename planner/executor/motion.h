// A trajectory in the executor. One thread prepares it, the control tick runs it, and the first thread reports the
// result.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/executor/checked_stops.h"
#include "planner/executor/figures.h"
#include "planner/protocol/execution_messages.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kWatched = 0.5;  // [s] after the end, in which the residual vibration is watched

enum class Ending {
  kReached,        // within the tolerances of the goal
  kPathTolerance,  // a link left the plan
  kGoalTolerance,  // a link did not come to rest at the goal in time
  kCommanded,      // hold or stop
  kEncoderLost,
  kStalled,   // control ticks were missed
  kNoStop,    // there is no checked stop motion for the instants ahead
  kNotBegun,  // held or stopped before its first tick, or no longer at rest
  kShutDown,  // the executor was ended
};

struct Outcome {
  Ending ending = Ending::kReached;
  double time = 0;  // [s] of the trajectory, when it was detected
  int joint = 0;    // 1 or 2
  double value = 0, allowed = 0;
  const char* what = "";  // name of the encoder, the quantity or the command, depending on `ending`
};

struct LogRow {
  double time;                      // [s] of the trajectory
  Joints<double> q, theta, torque;  // [rad] measured at `time`; [N m] commanded from then on
  Sample planned;
};

// The samples are inexact, exceed a limit, or deviate too far from the plan. Such a trajectory is never run, wherever
// the arm is.
struct RowsRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CommandedMotion {
  TrajectoryOrder order;
  Tolerances tolerances;  // with defaults filled in for zeros
  Trajectory trajectory;  // the samples, and rest at the goal after them
  double end = 0;         // [s] time of the last sample of the order
  std::optional<CheckedStops> stops;

  // Filled in the tick, which does not allocate.
  std::vector<LogRow> log;  // has capacity for the longest possible execution
  Figures figures;
  Outcome outcome;
  Joints<double> ended_at{};  // [rad] of the links
  long missed_ticks = 0;      // during the motion
};

// Prepares a motion without stop motions: at any instant its own end is the only way to rest.
std::unique_ptr<CommandedMotion> prepare_without_stops(const Parameters& robot, TrajectoryOrder order,
                                                       const Tolerances& defaults);

// Stop motions are checked this far [s] ahead before a motion begins.
inline constexpr double kLead = 0.1;

// Prepares a motion with stop motions, and trusts neither. Judges its samples (by judge_closed_loop(), or for learnt
// ones by a rollout on the model) and checks its stops from the first on. If the order has no stops, they are computed
// here, which takes about 0.2 s per second of motion. The motion may begin when this returns: its stops are then
// checked for `lead` [s], and the others are checked in the background. Throws std::runtime_error, RowsRefused or
// NoStop with one sentence if the motion must not be run or is `unwanted`.
std::unique_ptr<CommandedMotion> prepare(const Parameters& robot, TrajectoryOrder order, const Tolerances& defaults,
                                         double lead, const std::stop_token& unwanted);

// Returns the result that is reported, without log_file.
ExecutionResult result_of(const CommandedMotion& motion, const Parameters& robot);

// Return the logged ticks of the motion, and the run as it is published, with at most kMaxRows of them.
std::vector<ExecutedRow> ticks_of(const CommandedMotion& motion);
ExecutedRun run_of(const CommandedMotion& motion, const ExecutionResult& result);

}  // namespace fjr
