// fjr completion: what a shell may complete, from the same description as --help.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "planner/program/commands.h"
#include "planner/program/misspelt.h"

namespace fjr {
namespace {

// Everything that may be typed after one command.
struct CompletedCommand {
  std::string path;                  // "fjr batch run"
  std::vector<std::string> names;    // subcommands, and choices of positionals
  std::vector<std::string> options;  // with their dashes
};

struct CompletedValue {
  std::string option;                // "fjr plan --linear-solver"
  std::vector<std::string> choices;  // empty: anything, such as a file
};

struct Completions {
  std::vector<CompletedCommand> commands;  // the first is fjr itself
  std::vector<CompletedValue> values;      // of options that have one
};

// Returns the choices "{a,b}" within the type that --help shows (one_of()).
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  return names;
}

void collect(const CLI::App& app, const std::string& path, Completions& all) {
  CompletedCommand command{path, shown_subcommands(app), {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    const std::vector<std::string> choices = choices_of(*option), names = names_of(*option);
    if (option->get_positional()) command.names.insert(command.names.end(), choices.begin(), choices.end());
    command.options.insert(command.options.end(), names.begin(), names.end());
    if (option->get_items_expected_max() == 0) continue;  // a flag
    for (const std::string& name : names) all.values.push_back({fmt::format("{} {}", path, name), choices});
  }
  all.commands.push_back(std::move(command));
  for (const std::string& name : shown_subcommands(app)) {
    collect(*app.get_subcommand(name), fmt::format("{} {}", path, name), all);
  }
}

constexpr const char* kBash =
    R"(# Made by `fjr completion bash`. In zsh: autoload -U bashcompinit && bashcompinit, then the same.
_fjr() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command=fjr names= options= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${{COMP_WORDS[i]}}" in
      {}) command+=" ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$command" in
{}  esac
  [[ $current == -* ]] && names=$options
  case "$command ${{COMP_WORDS[COMP_CWORD-1]}}" in
{}    {}) names= ;;
  esac
  COMPREPLY=($(compgen -W "$names" -- "$current"))
}}
complete -o default -F _fjr fjr
)";

// Returns a pattern of the shell's `case`.
std::string any_of(const std::vector<std::string>& texts) { return fmt::format("\"{}\"", fmt::join(texts, "\" | \"")); }

std::string bash(const Completions& all) {
  std::vector<std::string> below, unlisted;
  std::string words, values;
  for (const CompletedCommand& command : all.commands) {
    if (&command != &all.commands.front()) below.push_back(command.path);
    words += fmt::format("    \"{}\") names=\"{}\" options=\"{}\" ;;\n", command.path, fmt::join(command.names, " "),
                         fmt::join(command.options, " "));
  }
  for (const CompletedValue& value : all.values) {
    if (value.choices.empty()) {
      unlisted.push_back(value.option);
      continue;
    }
    values += fmt::format("    \"{}\") names=\"{}\" ;;\n", value.option, fmt::join(value.choices, " "));
  }
  return fmt::format(kBash, any_of(below), words, values, any_of(unlisted));
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "completion", "Print what has a shell complete command lines of fjr: source <(fjr completion bash)");
  command->add_option("SHELL", "Also for zsh, after `autoload -U bashcompinit && bashcompinit`")
      ->check(one_of({"bash"}))
      ->required();
  command->callback([&app, &exit_code] {
    Completions all;
    collect(app, app.get_name(), all);
    fmt::print("{}", bash(all));
    exit_code = 0;
  });
}

}  // namespace fjr
