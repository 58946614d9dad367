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

// Puts such a text in place of `file` once it has been read back, and returns what was read. Text that is refused is
// left beside it as FILE.refused, and the file as it was. Throws InputError.
Parameters write_robot_file(const std::filesystem::path& file, const std::string& text);

}  // namespace fjr
