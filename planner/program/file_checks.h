// What files an option of the command line may name: found out before anything is computed for them.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <system_error>

namespace fjr {

// A file that can be made or replaced: in a folder that is there.
inline CLI::Validator file_to_write() {
  const auto fault = [](const std::string& text) {
    const std::filesystem::path file = text, folder = file.has_parent_path() ? file.parent_path() : ".";
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) return fmt::format("{} is a folder, not a file", text);
    if (std::filesystem::is_directory(folder, ignored)) return std::string();
    return fmt::format("cannot write {}: there is no folder {}", text, folder.string());
  };
  return CLI::Validator(fault, "");
}

}  // namespace fjr
