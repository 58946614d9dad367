// Checks of files that options of the command line name, made before anything is computed for them.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "common/input_error.h"

namespace fjr {

// Returns why a file cannot be made or replaced; empty if it can. Its folder has to exist and be writable, and it must
// not be a device or one of the files that make a folder a plan.
inline std::string fault_of_file_to_write(const std::string& name) {
  const std::filesystem::path file = name, folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) return fmt::format("{} is a folder, not a file", name);
  if (!std::filesystem::is_directory(folder, ignored)) {
    return fmt::format("cannot write {}: there is no folder {}", name, folder.string());
  }
  const std::filesystem::file_status there = std::filesystem::status(file, ignored);
  const bool replaceable = !std::filesystem::exists(there) || std::filesystem::is_regular_file(there);
  if (!replaceable || std::filesystem::weakly_canonical(folder, ignored) == "/dev") {
    return fmt::format("{} is a device or a pipe, which a file would replace", name);
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return fmt::format("cannot write {}: {}", name, std::generic_category().message(errno));
  }
  for (const char* of_plan : {"plan.json", "trajectory.csv", "solution.cbor"}) {
    if (file.filename() == of_plan && std::filesystem::exists(file, ignored)) {
      return fmt::format("{} belongs to a plan, and would be lost", name);
    }
  }
  return "";
}

// Throws InputError if the file that an option has named is one that the command reads, perhaps by another name. Inputs
// that are not there, or that are empty because their option was not given, are no matter here.
inline void refuse_to_overwrite(const std::string& option, const std::filesystem::path& out,
                                const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (out.empty() || input.empty() || !std::filesystem::equivalent(input, out, ignored)) continue;
    throw InputError(
        option, "",
        fmt::format("{} would overwrite the input {}; name a file that is not an input", out.string(), input));
  }
}

inline CLI::Validator file_to_write() { return CLI::Validator(fault_of_file_to_write, ""); }

}  // namespace fjr
