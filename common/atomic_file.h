// Writes files that are either complete or do not exist.
#pragma once

#include <filesystem>
#include <string_view>

namespace fjr {

// Writes `text` to a temporary file in the same folder and renames it: a reader sees the old content or all of the new.
// Throws std::runtime_error, one sentence with the path and the system's reason; nothing is left behind.
void write_file(const std::filesystem::path& file, std::string_view text);

// Writes likewise, and the file is on the disk when it returns, for data that must survive a power failure.
void write_file_durably(const std::filesystem::path& file, std::string_view text);

// Returns the name of a temporary file in the same folder. It is random, because processes in two containers that share
// the folder may have the same process id.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

}  // namespace fjr
