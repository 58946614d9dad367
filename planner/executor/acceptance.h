// Decides which trajectories the executor accepts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "planner/protocol/execution_messages.h"

namespace fjr {

struct Situation {
  std::string robot_hash;
  std::int64_t started = 0, now = 0;  // [ns] since 1970, UTC
  std::int64_t halted = 0;            // [ns] likewise, when it was last told to hold or to stop
  ExecutorMode mode = ExecutorMode::kResting;
  std::uint64_t epoch = 0;      // largest seen
  Joints<double> q{};           // [rad] where the links are
  Joints<double> rest_theta{};  // [rad] of the motors in equilibrium with them
  Joints<double> theta{};       // [rad] where the motors are
  std::string lost;             // an encoder without samples; empty: none
  double oldest = 10;           // [s] largest accepted age of a trajectory since it was published
};

// [s] Shortest accepted time between two samples: a tenth of that at a jump of the torque. The longest is
// kLongestSpacing.
inline constexpr double kShortestSpacing = 0.1 * kJumpSpacing;
inline constexpr double kClockDifference = 0.1;  // [s] between the planner's and the executor's machine

// Why a trajectory is not run. refusal_of() returns nothing if it may run.
struct ExecutionRefusal {
  ResultCode code;
  std::string sentence;
};
std::optional<ExecutionRefusal> refusal_of(const TrajectoryOrder& order, const Situation& situation);

}  // namespace fjr
