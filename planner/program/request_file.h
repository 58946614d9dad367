// Reads requests that the command line names: files, or `-` for standard input.
#pragma once

#include <filesystem>
#include <string>

namespace fjr {

inline constexpr const char* kStandardInput = "-";

struct RequestFile {
  std::string text;
  std::string source;            // for messages; its stem is the plan's name: that of standard input is `stdin`
  std::filesystem::path folder;  // what a relative `robot` is relative to
};

// Returns the name of a request in messages, without reading it.
std::filesystem::path source_of(const std::string& named);

// Throws InputError if it cannot be read.
RequestFile read_request_file(const std::string& named);

}  // namespace fjr
