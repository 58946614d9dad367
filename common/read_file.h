// Whole files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace fjr {

// The bytes of the file, nothing where there is none. Throws std::runtime_error, one sentence with the path and the
// system's reason, where it cannot be opened, or not be read to its end: a file that cannot be read is not an empty
// one.
std::optional<std::string> read_file(const std::filesystem::path& file);

}  // namespace fjr
