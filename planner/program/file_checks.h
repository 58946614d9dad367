// Checks of files that options of the command line name, made before anything is computed for them.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
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
  if (!std::filesystem::exists(there)) return "";
  for (const char* of_plan :
       {"plan.json", "trajectory.csv", "trajectory.uncertified.csv", "trajectory.id", "solution.cbor"}) {
    if (file.filename() == of_plan) return fmt::format("{} belongs to a plan, and would be lost", name);
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

// Throws InputError if the file that an option has named is there and does not have the ending (".html") of what would
// be written, because it is something else then: a robot, or a request.
inline void refuse_another_kind(const std::string& option, const std::string& out, std::string_view ending) {
  const std::string given = std::filesystem::path(out).extension().string();
  const bool short_form = (ending == ".yaml" && given == ".yml") || (ending == ".html" && given == ".htm");
  std::error_code ignored;
  if (out.empty() || given == ending || short_form || !std::filesystem::exists(out, ignored)) return;
  throw InputError(option, "",
                   fmt::format("{} is there, and would be lost: it is no {} file by its name", out, ending));
}

inline CLI::Validator file_to_write() { return CLI::Validator(fault_of_file_to_write, ""); }

// Makes a folder that an option or a key names, unless it is there. Throws InputError if that fails, or if files cannot
// be made in it.
inline void make_writable_folder(const std::string& named_by, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (!error && !std::filesystem::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) {
    throw InputError(named_by, "", fmt::format("cannot write to folder {}: {}", folder.string(), error.message()));
  }
}

}  // namespace fjr
