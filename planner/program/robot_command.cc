// fjr robot: writes a robot.yaml for another arm, or checks whether such an arm is possible.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "model/new_robot.h"
#include "model/robot_check.h"
#include "planner/program/commands.h"
#include "planner/program/file_checks.h"
#include "planner/program/request_file.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

// ---- check ----

const char* word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kFine:
      return "fine";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kImpossible:
      return "impossible";
  }
  return "";
}

std::string line(const Finding& finding) {
  return fmt::format("  {:<10} {}, joint {}: {}\n", word(finding.verdict), finding.check, finding.joint,
                     finding.sentence);
}

bool any_impossible(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.verdict == Verdict::kImpossible; });
}

nlohmann::ordered_json json_of(const std::string& file, const Parameters& robot, const std::vector<Finding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"verdict", word(finding.verdict)},
                    {"check", finding.check},
                    {"field", finding.field},
                    {"joint", finding.joint},
                    {"sentence", finding.sentence}});
  }
  return {{"robot", file},
          {"robot_hash", robot_hash(robot)},
          {"possible", !any_impossible(findings)},
          {"findings", std::move(list)}};
}

int check(const std::string& file, bool json) {
  const Parameters robot = parameters_as_written(file);
  const std::vector<Finding> findings = check_robot(robot);
  const bool impossible = any_impossible(findings);
  if (!impossible) (void)load_parameters(fs::path(file));  // whatever else planning would refuse
  if (json) {
    fmt::print("{}", json_text(json_of(file, robot, findings)));
  } else {
    fmt::print("{}: {}\n", file, impossible ? "there can be no such arm" : "there can be such an arm");
    for (const Verdict verdict : {Verdict::kImpossible, Verdict::kDoubtful, Verdict::kFine}) {
      for (const Finding& finding : findings) {
        if (finding.verdict == verdict) fmt::print("{}", line(finding));
      }
    }
  }
  return impossible ? 2 : 0;
}

// ---- new ----

// Returns an answer as a YAML value; pairs need no brackets.
std::string as_value(const std::string& answer) {
  const bool list = answer.find(',') != std::string::npos;
  const bool bare = answer.find_first_of("[{\"") == std::string::npos;
  return list && bare ? "[" + answer + "]" : answer;
}

// Returns what is wrong with an answer, if anything is.
std::optional<std::string> fault_of(const Key& key, const std::string& answer) {
  try {
    check_answer(key, YamlNode::parse(fmt::format("{}: {}\n", key.name, answer), "answer").at(key.name));
    return std::nullopt;
  } catch (const InputError& error) {
    return error.problem();
  }
}

// Asks a question until the answer can be read. Returns the answer; empty for the default.
std::string ask(const Key& key) {
  const std::string unit = *key.unit == '\0' ? "" : fmt::format(" [{}]", key.unit);
  for (;;) {
    fmt::print("{}{}: {}{}\n> ", key.name, unit, key.meaning,
               key.required() ? "" : fmt::format(" (Enter: {})", key.otherwise));
    std::fflush(stdout);
    std::string answer;
    if (!std::getline(std::cin, answer)) throw InputError("standard input", key.name, "ended before it was answered");
    answer = as_value(answer);
    if (answer.find_first_not_of(" \t") == std::string::npos) {
      if (!key.required()) return "";
      fmt::print("  is needed\n");
      continue;
    }
    const std::optional<std::string> fault = fault_of(key, answer);
    if (!fault) return answer;
    fmt::print("  {}\n", *fault);
  }
}

std::string interview() {
  fmt::print("Joint 1 is at the base, joint 2 at the elbow: two numbers, joint 1 first, with a comma between them.\n");
  std::string text;
  for (const Key& key : description_keys()) {
    const std::string answer = ask(key);
    if (!answer.empty()) text += fmt::format("{}: {}\n", key.name, answer);
  }
  return text;
}

std::string keys_for_help() {
  std::string text = "Keys of DESCRIPTION.yaml, [joint 1, joint 2] where there are two numbers:\n";
  for (const Key& key : description_keys()) {
    text += fmt::format("  {:<15} {:<8} {}; {}\n", key.name, key.unit, key.meaning,
                        key.required() ? "needed" : fmt::format("left out: {}", key.otherwise));
  }
  return text;
}

int make(const std::string& description, const std::string& out) {
  if (fs::exists(out)) throw InputError(out, "", "is there already; name a file that is not, or move that one away");
  const bool asked = description.empty();
  if (asked && ::isatty(STDIN_FILENO) == 0) {
    throw InputError("command line", "", "a description is needed where there is no terminal to ask on (see --help)");
  }
  const RequestFile file = asked ? RequestFile{interview(), "answers", "."} : read_request_file(description);
  try {
    const NewRobot robot = new_robot(YamlNode::parse(file.text, file.source));
    write_file(out, robot.yaml);
    fmt::print("{}\n", out);
    for (const Finding& finding : check_robot(robot.parameters)) {
      if (finding.verdict != Verdict::kFine) fmt::print("{}", line(finding));
    }
  } catch (const InputError&) {
    if (asked) fmt::print("The answers, as a file to correct and to give to fjr robot new:\n{}", file.text);
    throw;
  }
  return 0;
}

}  // namespace

void add_robot(CLI::App& app, int& exit_code) {
  CLI::App* robot = app.add_subcommand("robot", "Write a robot.yaml for another arm, or check one");
  robot->require_subcommand(1);

  struct Arguments {
    std::string file, out;
    bool json = false;
  };
  const auto options = std::make_shared<Arguments>();
  CLI::App* fresh = robot->add_subcommand(
      "new",
      "Write a complete robot.yaml from lengths, masses, springs and drives: asked for on a terminal, or in a file");
  fresh->add_option("description", options->file, "Short description of the arm, - for standard input")
      ->type_name("DESCRIPTION.yaml|-");
  fresh->add_option("--out", options->out, "File to write; one that is there already is left alone")
      ->required()
      ->type_name("ROBOT.yaml")
      ->check(file_to_write());
  fresh->footer(keys_for_help());
  fresh->callback([options, &exit_code] { exit_code = make(options->file, options->out); });

  CLI::App* checked = robot->add_subcommand(
      "check", "Whether there can be such an arm, and what it is able to, each with its number; exit code 2 if not");
  checked->add_option("robot", options->file, "File to check")->required()->type_name("ROBOT.yaml");
  checked->add_flag("--json", options->json, "Only JSON on stdout");
  checked->callback([options, &exit_code] { exit_code = check(options->file, options->json); });
}

}  // namespace fjr
