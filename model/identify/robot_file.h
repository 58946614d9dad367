// robot.yaml from what was identified.
#pragma once

#include <filesystem>
#include <string>

#include "model/identify/arm.h"

namespace fjr {

// A complete robot.yaml: identified values with standard errors, covariance, and the logs they come from with their
// hashes; everything else as it stands in the file `base`. The identified link damping is written as the model's only
// if `use_damping`; otherwise it is told in its source.
std::string format_robot(const Identified& identified, const std::filesystem::path& base, bool use_damping);

}  // namespace fjr
