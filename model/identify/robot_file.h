// Writes a robot.yaml with identified parameters.
#pragma once

#include <filesystem>
#include <string>

#include "model/identify/arm.h"

namespace fjr {

// Returns a complete robot.yaml: the identified values with standard errors, covariance, and the logs with their
// hashes; everything else as in the file `base`. The identified link damping is used for the model only if
// `use_damping`; otherwise it is mentioned in the entry's source.
std::string format_robot(const Identified& identified, const std::filesystem::path& base, bool use_damping);

// Replaces `file` by such a text after reading it back successfully, and returns the parameters read. Throws InputError
// if the text is refused; it is then left beside the file as FILE.refused, and the file stays unchanged.
Parameters write_robot_file(const std::filesystem::path& file, const std::string& text);

}  // namespace fjr
