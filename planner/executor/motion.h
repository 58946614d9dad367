// A trajectory on its way through the executor: prepared by one thread, run by the other, reported by the first again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planner/executor/figures.h"
#include "planner/service/execution_messages.h"
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
  double time;                    // [s] of the trajectory
  Pair<double> q, theta, torque;  // [rad] measured at `time`; [N m] commanded from then on
  Sample planned;
};

struct CommandedMotion {
  TrajectoryOrder order;
  Tolerances tolerances;  // resolved: nothing is 0
  Trajectory trajectory;  // the rows, and rest at the goal after them
  double end = 0;         // [s] of the rows
  std::vector<Trajectory> stops;

  // Filled in the tick; nothing is allocated there.
  std::vector<LogRow> log;  // capacity for the longest course of events
  Figures figures;
  Outcome outcome;
  Pair<double> ended_at{};  // [rad] of the links
  long missed_ticks = 0;    // during the motion
};

// Without stop motions: from any instant its own end is the way to rest.
std::unique_ptr<CommandedMotion> prepare_without_stops(const Parameters& robot, TrajectoryOrder order,
                                                       const Tolerances& defaults);

// With them. Throws NoStop. `between` is called now and then.
std::unique_ptr<CommandedMotion> prepare(const Parameters& robot, TrajectoryOrder order, const Tolerances& defaults,
                                         const std::function<void()>& between);

// What is reported about it; without log_file.
ExecutionResult result_of(const CommandedMotion& motion, const Parameters& robot);

}  // namespace fjr
