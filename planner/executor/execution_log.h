// The log of one execution: CSV as in DESIGN 5.6, which model/log.h reads.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "planner/executor/motion.h"

namespace fjr {

// Writes it into `folder`, complete or not at all, and returns its path. Columns are measured and planned values; times
// are of the trajectory. Throws std::runtime_error.
std::filesystem::path write_log(const CommandedMotion& motion, const ExecutionResult& result,
                                const std::filesystem::path& folder, std::map<std::string, std::string> metadata);

}  // namespace fjr
