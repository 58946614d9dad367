#include "planner/executor/execution_log.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <string_view>

#include "common/atomic_file.h"
#include "model/log.h"

namespace fjr {
namespace {

void add(Log& log, std::string_view quantity, std::string_view suffix, const CommandedMotion& motion,
         const Joints<double>& (*get)(const LogRow&)) {
  for (int joint = 0; joint < kJoints; ++joint) {
    log.names.push_back(joint_column(quantity, joint, suffix));
    std::vector<double> values;
    for (const LogRow& row : motion.log) values.push_back(get(row)[static_cast<std::size_t>(joint)]);
    log.values.push_back(std::move(values));
  }
}

using Columns = const Joints<double>&;

}  // namespace

Log log_of(const CommandedMotion& motion) {
  Log log;
  log.metadata["missed_ticks"] = std::to_string(motion.missed_ticks);
  log.names.push_back("time");
  log.values.emplace_back();
  for (const LogRow& row : motion.log) log.values.back().push_back(row.time);
  add(log, "q", "", motion, [](const LogRow& r) -> Columns { return r.q; });
  add(log, "theta", "", motion, [](const LogRow& r) -> Columns { return r.theta; });
  add(log, "tau", "", motion, [](const LogRow& r) -> Columns { return r.torque; });
  add(log, "q", "_plan", motion, [](const LogRow& r) -> Columns { return r.planned.state.q; });
  add(log, "theta", "_plan", motion, [](const LogRow& r) -> Columns { return r.planned.state.theta; });
  add(log, "tau", "_plan", motion, [](const LogRow& r) -> Columns { return r.planned.torque; });
  return log;
}

std::filesystem::path write_log(const CommandedMotion& motion, const ExecutionResult& result,
                                const std::filesystem::path& folder,
                                const std::map<std::string, std::string>& metadata) {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  Log log = log_of(motion);
  for (const auto& [key, value] : metadata) log.metadata[key] = value;
  log.metadata["robot_id"] = motion.order.robot_id;
  log.metadata["robot_hash"] = motion.order.robot_hash;
  log.metadata["request_hash"] = motion.order.request_hash;
  log.metadata["trajectory"] = fmt::format("{}-{}", client_name(motion.order.id), motion.order.id.number);
  log.metadata["written"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  log.metadata["code"] = std::to_string(static_cast<std::int32_t>(result.code));
  if (!result.sentence.empty()) log.metadata["sentence"] = result.sentence;
  const std::string name = fmt::format("{:%Y%m%dT%H%M%SZ}_{}.csv", fmt::gmtime(now), text(motion.order.id));
  const std::filesystem::path file = std::filesystem::absolute(folder) / name;
  write_file(file, format_log(log));
  return file;
}

}  // namespace fjr
