#include "planner/protocol/execution_messages.h"

#include <fmt/format.h>

#include <utility>

#include "model/log.h"

namespace fjr {

Log log_of(const std::vector<ExecutedRow>& ticks, std::uint32_t missed_ticks) {
  Log log;
  log.metadata["missed_ticks"] = std::to_string(missed_ticks);
  const auto add = [&](std::string name, const auto& value_in) {
    log.names.push_back(std::move(name));
    std::vector<double>& values = log.values.emplace_back();
    values.reserve(ticks.size());
    for (const ExecutedRow& tick : ticks) values.push_back(value_in(tick));
  };
  const auto add_pair = [&](const char* quantity, const char* suffix, Joints<double> ExecutedRow::*pair) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      add(joint_column(quantity, static_cast<int>(j), suffix),
          [&](const ExecutedRow& tick) { return (tick.*pair)[j]; });
    }
  };
  add("time", [](const ExecutedRow& tick) { return tick.time; });
  add_pair("q", "", &ExecutedRow::q);
  add_pair("theta", "", &ExecutedRow::theta);
  add_pair("tau", "", &ExecutedRow::torque);
  add_pair("q", "_plan", &ExecutedRow::planned_q);
  add_pair("theta", "_plan", &ExecutedRow::planned_theta);
  return log;
}

bool has_moved(ResultCode code) {
  return code == ResultCode::kSuccessful || code == ResultCode::kPathToleranceViolated ||
         code == ResultCode::kGoalToleranceViolated;
}

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
    case ResultCode::kRepetitionRefused:
      return "REPETITION_REFUSED";
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

bool news(const std::optional<ArmDrift>& before, const ArmDrift& now) {
  if (!before) return now.drifts;
  return before->drifts != now.drifts || (now.drifts && before->parameter != now.parameter);
}

std::string sentence_of(const ArmDrift& drift) {
  const char* plural = drift.motions == 1 ? "" : "s";
  if (!drift.drifts) {
    return fmt::format("{} motion{} as robot.yaml has it (evidence of a drift {:.2g}, alarm above {:g})", drift.motions,
                       plural, drift.evidence, drift.alarm);
  }
  std::string off = fmt::format("{:.6g} +- {:.1g} {}", drift.known + drift.change, drift.change_error, drift.unit);
  if (drift.known != 0) off += fmt::format(", {:+.2g} %", 100 * drift.change / drift.known);
  return fmt::format(
      "drifts from robot.yaml since {} ({} of {} motion{}): {} is {} and not {:.6g}, for which {:.0f} % of the "
      "evidence "
      "speaks (false alarms: one in {:g} motions at most)",
      text(drift.since), drift.motions_since, drift.motions, plural, drift.parameter, off, drift.known,
      100 * drift.share, drift.alarm);
}

}  // namespace fjr
