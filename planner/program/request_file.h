// Requests as a command line names them: files, or `-` for standard input.
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

// How a request is called in messages, without reading it.
std::filesystem::path source_of(const std::string& named);

// Throws InputError for what cannot be read.
RequestFile read_request_file(const std::string& named);

}  // namespace fjr
