// robot.yaml from what executed motions told.
#pragma once

#include <filesystem>
#include <vector>

#include "planner/identify/executed.h"

namespace fjr {

// A complete robot.yaml: values after, standard errors and covariance, and the logs with their hashes for what was
// refined. What is no possible arm is refused (InputError), and the file that may be there already stays. base: what
// was known. Returns what was written, read again.
Parameters write_executed_robot(const std::filesystem::path& file, const std::filesystem::path& base,
                                const ExecutedFit& fit, const std::vector<ExecutedMotion>& motions);

}  // namespace fjr
