#include "planner/protocol/execution_messages.h"

namespace fjr {

const char* name(ResultCode code) {
  switch (code) {
    case ResultCode::kSuccessful:
      return "SUCCESSFUL";
    case ResultCode::kInvalidGoal:
      return "INVALID_GOAL";
    case ResultCode::kInvalidJoints:
      return "INVALID_JOINTS";
    case ResultCode::kOldHeaderTimestamp:
      return "OLD_HEADER_TIMESTAMP";
    case ResultCode::kPathToleranceViolated:
      return "PATH_TOLERANCE_VIOLATED";
    case ResultCode::kGoalToleranceViolated:
      return "GOAL_TOLERANCE_VIOLATED";
  }
  return "unknown";  // from an executor of another version
}

const char* name(ExecutorMode mode) {
  switch (mode) {
    case ExecutorMode::kResting:
      return "resting";
    case ExecutorMode::kExecuting:
      return "executing";
    case ExecutorMode::kStopping:
      return "stopping";
    case ExecutorMode::kHolding:
      return "holding";
    case ExecutorMode::kStopped:
      return "stopped";
    case ExecutorMode::kPreparing:
      return "preparing";
  }
  return "unknown";  // from an executor of another version
}

}  // namespace fjr
