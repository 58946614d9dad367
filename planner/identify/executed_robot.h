// Writes a robot.yaml with the parameters identified from executed motions.
#pragma once

#include <filesystem>
#include <vector>

#include "planner/identify/executed.h"

namespace fjr {

// Writes a complete robot.yaml: the identified values, standard errors and covariance and, for refined parameters, the
// logs with their hashes. Throws InputError if the parameters are physically impossible; an existing file then stays.
// base: the robot file known before. Returns the parameters as read back from the written file.
Parameters write_executed_robot(const std::filesystem::path& file, const std::filesystem::path& base,
                                const ExecutedFit& fit, const std::vector<ExecutedMotion>& motions);

}  // namespace fjr
