// One trajectory on its way through the control tick: command, measure, judge.
#pragma once

#include <optional>

#include "planner/certificate/tracking.h"
#include "planner/executor/arm.h"
#include "planner/service/execution_messages.h"

namespace fjr {

inline constexpr double kPathTolerance = 0.02;   // [rad] unless the order says otherwise
inline constexpr double kGoalTolerance = 0.005;  // [rad]
inline constexpr double kGoalTime = 0.5;         // [s] after the end, in which the residual vibration is watched

// Runs until the end and kGoalTime beyond it; afterwards it keeps the arm at the goal, as long as it is ticked.
class Execution {
 public:
  Execution(const Parameters& robot, TrajectoryOrder order);
  Execution(const Execution&) = delete;  // the controller refers to the trajectory
  Execution& operator=(const Execution&) = delete;

  void tick(Arm& arm);

  bool executing() const { return !result_; }
  const std::optional<ExecutionResult>& result() const { return result_; }
  ExecutorState state() const { return state_; }  // of the last tick; what is not of the trajectory is left out

  // Keeps the arm where it is, at rest.
  static TrajectoryOrder rest(const Parameters& robot, const Pair<double>& q);

 private:
  void judge(const Pair<double>& error);
  void end(ResultCode code, const std::string& sentence);

  TrajectoryOrder order_;
  double end_;  // [s] of the motion; the goal is held after it
  Trajectory trajectory_;
  Interpolator plan_;
  TickController controller_;
  long ticks_ = 0, measured_ = 0;
  ExecutionResult so_far_;
  std::optional<ExecutionResult> result_;
  ExecutorState state_;
};

}  // namespace fjr
