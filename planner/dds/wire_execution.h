// Trajectories, the executor's state and its results on the wire.
#pragma once

#include <fjr_msgs.h>

#include <optional>
#include <vector>

#include "planner/protocol/execution_messages.h"

namespace fjr::dds {

// The message points into `order`, which must outlive it; nothing is copied.
fjr_msg_Trajectory encode(const TrajectoryOrder& order);
TrajectoryOrder decode(const fjr_msg_Trajectory& message);
fjr_msg_Trajectory2 encode_2(const TrajectoryOrder& order);
TrajectoryOrder decode(const fjr_msg_Trajectory2& message);
fjr_msg_LearntTrajectory encode_learnt(const TrajectoryOrder& order);
TrajectoryOrder decode(const fjr_msg_LearntTrajectory& message);

fjr_msg_ExecutorState encode(const ExecutorState& state);
ExecutorState decode(const fjr_msg_ExecutorState& message);

fjr_msg_ExecutorCommand encode(const ExecutorOrder& order);
std::optional<ExecutorOrder> decode(const fjr_msg_ExecutorCommand& message);  // none: an unknown command

// The message points into `limits`.
struct WireResult {
  std::vector<fjr_msg_LimitMargin> limits;
  fjr_msg_ExecutionResult message{};
};
WireResult encode(const ExecutionResult& result);
ExecutionResult decode(const fjr_msg_ExecutionResult& message);

// The message points into `run`, as above.
fjr_msg_ExecutedRun encode(const ExecutedRun& run);
ExecutedRun decode(const fjr_msg_ExecutedRun& message);

fjr_msg_ArmDrift encode(const ArmDrift& drift);
ArmDrift decode(const fjr_msg_ArmDrift& message);

}  // namespace fjr::dds
