#include "planner/program/plan_settings.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "planner/nlp/linear_solver.h"
#include "planner/program/misspelt.h"
#include "planner/program/number_checks.h"
#include "planner/search/settings_file.h"

namespace fjr {

void add_options(CLI::App& command, PlanSettings& settings) {
  command
      .add_option(
          "--linear-solver", settings.plan.linear_solver,
          "Solver of the linear systems; ma27 to ma97 are taken from an HSL library, libhsl.so or the file that "
          "the environment variable FJR_HSL names")
      ->check(one_of(linear_solvers()))
      ->check(CLI::Validator([](const std::string& name) { return what_is_missing(name); }, ""))
      ->capture_default_str();
  command
      .add_option("--starts", settings.plan.starts,
                  "Starts of the optimiser; default by objective, 1 to 12; more never come to less")
      ->check(CLI::Range(1, 100));
  command.add_option("--deadline", settings.plan.deadline, "Wall time allowed for each request, in seconds")
      ->check(positive())
      ->type_name("S");
  command
      .add_option("--library", settings.library,
                  "Folder of a plan library: where it has a plan nearby, its solution is the start, and the plan if "
                  "that can be certified")
      ->type_name("DIR");
  command.add_flag("--keep-uncertified", settings.keep_uncertified,
                   "Write trajectories without certificate too, as trajectory.uncertified.csv");
  command.add_flag("--proven", settings.plan.proven,
                   "Certified only with bounds of errors and limits that hold with mathematical certainty");
}

void add_report_option(CLI::App& command, PlanSettings& settings) {
  command.add_flag("--report", settings.report, "Write report.html too: the motion, animated, and all about it");
}

void add_settings_option(CLI::App& command, PlanSettings& settings) {
  command
      .add_option_function<std::string>(
          "--settings",
          [&settings](const std::string& file) {
            settings.settings_file = file;
            settings.plan.search = load_settings(file);
          },
          "Settings of the search, in place of their defaults; fjr keys --settings lists them")
      ->type_name("SETTINGS.yaml");
}

std::vector<std::string> to_arguments(const PlanSettings& settings) {
  std::vector<std::string> words = {"--linear-solver", settings.plan.linear_solver};
  if (settings.plan.starts > 0) words.insert(words.end(), {"--starts", std::to_string(settings.plan.starts)});
  if (settings.plan.deadline > 0) words.insert(words.end(), {"--deadline", fmt::format("{}", settings.plan.deadline)});
  if (!settings.library.empty()) {
    words.insert(words.end(), {"--library", std::filesystem::absolute(settings.library).string()});
  }
  if (!settings.settings_file.empty()) {
    words.insert(words.end(), {"--settings", std::filesystem::absolute(settings.settings_file).string()});
  }
  if (settings.keep_uncertified) words.emplace_back("--keep-uncertified");
  if (settings.plan.proven) words.emplace_back("--proven");
  if (settings.report) words.emplace_back("--report");
  return words;
}

}  // namespace fjr
