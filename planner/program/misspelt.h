// Suggests corrections for command lines that CLI11 refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace fjr {

// Returns the subcommands that --help lists.
std::vector<std::string> shown_subcommands(const CLI::App& app);

// Returns what is wrong with a command line that the parser refuses with the sentence `said`. The first word that is no
// subcommand, or no option of its subcommand, is compared with the parser's lists: "no subcommand is called paln; did
// you mean plan?".
std::string refusal(const CLI::App& app, const std::vector<std::string>& words, const std::string& said);

// Makes a check that the value is one of `names`; the refusal names the nearest of them.
CLI::Validator one_of(std::vector<std::string> names);

}  // namespace fjr
