// The log of one execution: CSV as in docs/files.md, which model/log.h reads.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "model/log.h"
#include "planner/executor/motion.h"

namespace fjr {

// Measured and planned values; times are of the trajectory.
Log log_of(const CommandedMotion& motion);

// Writes it into `folder`, complete or not at all, with what became of it and `metadata`, and returns its path. Throws
// std::runtime_error.
std::filesystem::path write_log(const CommandedMotion& motion, const ExecutionResult& result,
                                const std::filesystem::path& folder,
                                const std::map<std::string, std::string>& metadata = {});

}  // namespace fjr
