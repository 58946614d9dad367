// What files an option of the command line may name: found out before anything is computed for them.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace fjr {

// A file that can be made or replaced is in a folder that is there and may be written to, and no device, nor one of
// those that make a folder a plan. Empty: nothing is wrong.
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

inline CLI::Validator file_to_write() { return CLI::Validator(fault_of_file_to_write, ""); }

}  // namespace fjr
