// Whole files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace fjr {

// Returns the bytes of the file, or nothing if it does not exist. Throws std::runtime_error, one sentence with the path
// and the system's reason, if it cannot be opened or read to its end: a file that cannot be read is not an empty one.
std::optional<std::string> read_file(const std::filesystem::path& file);

}  // namespace fjr
