// Which trajectories the executor runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "planner/service/execution_messages.h"

namespace fjr {

struct Situation {
  std::string robot_hash;
  std::int64_t started = 0, now = 0;  // [ns] since 1970, UTC
  ExecutorMode mode = ExecutorMode::kResting;
  std::uint64_t epoch = 0;  // largest seen
  Pair<double> q{};         // [rad] where the links are
  std::string lost;         // an encoder without samples; empty: none
  double oldest = 10;       // [s] since it was published
};

inline constexpr double kStartTolerance = 0.01;  // [rad] between the first row and where the links are

// One sentence and a code; nothing: it may run.
struct ExecutionRefusal {
  ResultCode code;
  std::string sentence;
};
std::optional<ExecutionRefusal> refusal_of(const TrajectoryOrder& order, const Situation& situation);

}  // namespace fjr
