#include "planner/executor/execution_log.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

#include "common/atomic_file.h"
#include "model/log.h"

namespace fjr {
Log log_of(const CommandedMotion& motion) {
  Log log = fjr::log_of(ticks_of(motion), static_cast<std::uint32_t>(motion.missed_ticks));
  for (std::size_t j = 0; j < kJoints; ++j) {
    log.names.push_back(joint_column("tau", static_cast<int>(j), "_plan"));
    std::vector<double>& values = log.values.emplace_back();
    for (const LogRow& row : motion.log) values.push_back(row.planned.torque[j]);
  }
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
