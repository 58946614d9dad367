// What a command line that CLI11 refuses may have meant.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fjr {

// Those that --help lists.
std::vector<std::string> shown_subcommands(const CLI::App& app);

// What is wrong with a command line that the parser refuses with the sentence `said`, and what its first word that is
// no subcommand, or no option of its subcommand, may have meant, by the parser's own lists: "no subcommand is called
// paln; did you mean plan?".
std::string refusal(const CLI::App& app, const std::vector<std::string>& words, const std::string& said);

// The value is one of `names`; what is not is refused with the nearest of them.
CLI::Validator one_of(std::vector<std::string> names);

}  // namespace fjr
