// What a command line that CLI11 refuses may have meant.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fjr {

// Those that --help lists.
std::vector<std::string> shown_subcommands(const CLI::App& app);

// "; did you mean plan?": for the first word of the command line that is no subcommand, or no option of its
// subcommand, by the parser's own lists. "" where none is near.
std::string suggestion(const CLI::App& app, const std::vector<std::string>& words);

// The value is one of `names`; what is not is refused with the nearest of them.
CLI::Validator one_of(std::vector<std::string> names);

}  // namespace fjr
