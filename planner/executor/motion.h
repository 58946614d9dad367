// A trajectory on its way through the executor: prepared by one thread, run by the other, reported by the first again.
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
  kNoStop,    // for what comes there is no stop motion that can be used
  kNotBegun,  // held or stopped before its first tick, or no longer at rest
  kShutDown,  // the executor was ended
};

struct Outcome {
  Ending ending = Ending::kReached;
  double time = 0;  // [s] of the trajectory, when it was noticed
  int joint = 0;    // 1 or 2
  double value = 0, allowed = 0;
  const char* what = "";  // the encoder, the quantity
};

struct LogRow {
  double time;                      // [s] of the trajectory
  Joints<double> q, theta, torque;  // [rad] measured at `time`; [N m] commanded from then on
  Sample planned;
};

// Of rows that are not exact, break a limit, or leave the plan too far: wherever the arm is, they are not run.
struct RowsRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CommandedMotion {
  TrajectoryOrder order;
  Tolerances tolerances;  // resolved: nothing is 0
  Trajectory trajectory;  // the rows, and rest at the goal after them
  double end = 0;         // [s] of the rows
  std::optional<CheckedStops> stops;

  // Filled in the tick; nothing is allocated there.
  std::vector<LogRow> log;  // capacity for the longest course of events
  Figures figures;
  Outcome outcome;
  Joints<double> ended_at{};  // [rad] of the links
  long missed_ticks = 0;      // during the motion
};

// Without stop motions: from any instant its own end is the way to rest.
std::unique_ptr<CommandedMotion> prepare_without_stops(const Parameters& robot, TrajectoryOrder order,
                                                       const Tolerances& defaults);

// How far ahead of the tick stop motions are checked before a motion begins. [s]
inline constexpr double kLead = 0.1;

// With them, and believing nobody: its rows are judged (judge_closed_loop, or where they were learnt on what the model
// does under them), its stops checked from the first on; where it brings none they are found, which takes about 0.2 s
// per second of motion. It may begin when this returns, and so many of its stops are checked that they last for `lead`
// [s]; the others follow. Throws std::runtime_error, one sentence: why it is not run, or that it is `unwanted`.
std::unique_ptr<CommandedMotion> prepare(const Parameters& robot, TrajectoryOrder order, const Tolerances& defaults,
                                         double lead, const std::stop_token& unwanted);

// What is reported about it; without log_file.
ExecutionResult result_of(const CommandedMotion& motion, const Parameters& robot);

// What was logged of it, tick by tick; and the same as it is told, at most kMaxRows of them.
std::vector<ExecutedRow> ticks_of(const CommandedMotion& motion);
ExecutedRun run_of(const CommandedMotion& motion, const ExecutionResult& result);

}  // namespace fjr
