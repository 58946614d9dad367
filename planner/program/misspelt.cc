#include "planner/program/misspelt.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "common/spelling.h"

namespace fjr {
namespace {

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string suggest(std::string_view word, const std::vector<std::string>& known) {
  return did_you_mean(word, {known.begin(), known.end()});
}

}  // namespace

std::vector<std::string> shown_subcommands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::string refusal(const CLI::App& app, const std::vector<std::string>& words, const std::string& said) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    if (word == "--") return said;
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      if (command->get_option_no_throw(name) != nullptr) continue;
      return fmt::format("no option is called {}{}", name, suggest(name, options_of(*command)));
    }
    const std::vector<std::string> known = shown_subcommands(*command);
    const auto found = std::find(known.begin(), known.end(), word);
    if (found != known.end()) {
      command = command->get_subcommand(word);
    } else if (!known.empty() && !word.starts_with("-")) {
      const std::string meant = suggest(word, known);
      if (command->get_require_subcommand_min() > 0) return fmt::format("no subcommand is called {}{}", word, meant);
      if (!meant.empty()) return said + meant;
    }
  }
  return said;
}

CLI::Validator one_of(std::vector<std::string> names) {
  const std::string shown = fmt::format("{{{}}}", fmt::join(names, ","));
  return CLI::Validator(
      [names = std::move(names)](const std::string& given) {
        if (std::find(names.begin(), names.end(), given) != names.end()) return std::string();
        return fmt::format("{} is not one of {}{}", given, fmt::join(names, ", "), suggest(given, names));
      },
      shown);
}

}  // namespace fjr
