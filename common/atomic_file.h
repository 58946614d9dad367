// Files that are either complete or not there.
#pragma once

#include <filesystem>
#include <string_view>

namespace fjr {

// Writes `text` to a temporary file in the same folder and renames it: a reader sees the old content or all of the new.
// Throws std::runtime_error, one sentence with the path and the system's reason; nothing is left behind.
void write_file(const std::filesystem::path& file, std::string_view text);

// The same, and on the disk when it returns: what has to be known after a power failure.
void write_file_durably(const std::filesystem::path& file, std::string_view text);

// The name of a temporary file in the same folder: random, because processes in two containers that share the folder
// may have the same number.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

}  // namespace fjr
