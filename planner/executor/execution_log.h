// The log of one execution: CSV as in docs/files.md, which model/log.h reads.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "model/log.h"
#include "planner/executor/motion.h"

namespace fjr {

// Returns the log of an execution with measured and planned values. Its times are those of the trajectory.
Log log_of(const CommandedMotion& motion);

// Writes the log with the result and `metadata` into `folder`, either completely or not at all, and returns its path.
// Throws std::runtime_error if it cannot be written.
std::filesystem::path write_log(const CommandedMotion& motion, const ExecutionResult& result,
                                const std::filesystem::path& folder,
                                const std::map<std::string, std::string>& metadata = {});

}  // namespace fjr
