// fjr identify: from logs to robot.yaml.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/say.h"
#include "model/identify/agreement.h"
#include "model/identify/from_files.h"
#include "model/identify/repeated.h"
#include "model/identify/report.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/file_checks.h"
#include "planner/program/identify_executed.h"
#include "planner/program/misspelt.h"
#include "planner/program/number_checks.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct IdentifyArguments {
  std::string name, out, report, robot;
  std::vector<std::string> logs, columns;
  int joint = 0;     // 1 or 2; 0: as the log says
  double widen = 1;  // times the standard errors of the robot file
  bool json = false, link_damping = false, accept_inconsistent = false, payload_known = false;
};

ColumnNames renamed_columns(const std::vector<std::string>& pairs) {
  ColumnNames renamed;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == pair.size()) {
      throw InputError("--column", "", "'" + pair + "' must be OURS=THEIRS, as in q1=link_1_position");
    }
    renamed[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return renamed;
}

std::string parameters_text(const Estimate& e) {
  std::string text = fmt::format("{}, joint {} ({})\n", e.procedure, e.joint + 1, e.log);
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    const double error = e.standard_error(e.names[i]);
    const bool assumed = e.is_assumed(e.names[i]);
    text += fmt::format("  {:<24} {:>12.6g}  {:<12} {}\n", e.names[i], e.value[static_cast<Eigen::Index>(i)],
                        e.units[i], assumed ? "assumed" : fmt::format("+- {:.2g} (95 %: {:.2g})", error, 1.96 * error));
  }
  return text;
}

std::string text_of(const Estimate& e) {
  std::string text = parameters_text(e);
  text += fmt::format("  {:<24} {} points, residual {:.3g} {}, R^2 {:.8f}\n", "fit", e.points, e.residual_rms,
                      e.residual_unit, e.r_squared);
  for (const std::string& warning : e.warnings) text += "  warning: " + warning + "\n";
  return text;
}

// Returns the combined result of several logs of one experiment, which robot.yaml contains.
std::string combined_text(const std::vector<Repeated>& all) {
  std::string text;
  for (const Repeated& r : all) {
    if (r.logs.size() > 1) text += "together: " + parameters_text(r.estimate);
  }
  return text;
}

nlohmann::ordered_json json_of(const Estimate& e) {
  nlohmann::ordered_json json{{"procedure", e.procedure}, {"joint", e.joint + 1}, {"log", e.log}, {"sha256", e.hash}};
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    nlohmann::ordered_json value{{"value", e.value[static_cast<Eigen::Index>(i)]}, {"unit", e.units[i]}};
    if (e.is_assumed(e.names[i])) {
      value["assumed"] = true;
    } else {
      value["standard_error"] = e.standard_error(e.names[i]);
    }
    json["parameters"][e.names[i]] = value;
  }
  json["points"] = e.points;
  json["residual_rms"] = e.residual_rms;
  json["residual_unit"] = e.residual_unit;
  json["r_squared"] = e.r_squared;
  json["warnings"] = e.warnings;
  return json;
}

Identification identify_as_asked(const IdentifyArguments& options, const Parameters& known) {
  const ColumnNames renamed = renamed_columns(options.columns);
  if (options.name != "all") return identify_logs(options.name, {options.logs, options.joint, renamed}, known);
  if (options.logs.size() != 1) {
    throw InputError(options.logs.front(), "", "'all' needs one folder with <experiment>_<joint>.csv");
  }
  return identify_folder(options.logs.front(), renamed, known);
}

std::string consistency_table(const std::vector<Agreement>& all) {
  std::string text = all.empty() ? "" : "consistency\n";
  for (const Agreement& a : all) text += "  " + a.sentence() + "\n";
  return text;
}

void tell_doubts(const std::vector<Agreement>& all, const std::vector<Change>& changes) {
  for (const Agreement& a : all) {
    if (a.standard_errors_apart() >= kDoubtfulApart) say("fjr: warning: {}\n", a.sentence());
  }
  for (const Change& change : changes) {
    if (change.is_large()) say("fjr: warning: {}\n", change.sentence());
  }
}

// Returns the report's file. For a whole identification it is beside robot.yaml, unless another file is requested.
fs::path report_file(const IdentifyArguments& options) {
  if (!options.report.empty() || options.name != "all" || options.out.empty()) return options.report;
  return fs::path(options.out).replace_extension(".html");
}

// Executed motions identify both joints and the whole arm at once, so options for single joints are refused.
int run_executed(const IdentifyArguments& options) {
  const auto refuse = [](bool given, const char* option, const char* why) {
    if (given) throw InputError(option, "", fmt::format("is not for `identify executed`: {}", why));
  };
  refuse(options.joint != 0, "--joint", "its logs are of both");
  refuse(!options.report.empty(), "--report", "there are no experiments to draw; --json has all figures");
  refuse(options.link_damping, "--link-damping", "link damping is refined where the robot file has its standard error");
  refuse(options.accept_inconsistent, "--accept-inconsistent", "its logs are fitted together");
  const PayloadMass payload = options.payload_known ? PayloadMass::kKnown : PayloadMass::kUncertain;
  return identify_executed({options.logs, options.robot, options.out, renamed_columns(options.columns), options.widen,
                            payload, options.json});
}

// Returns the logs as files; of `all` those in its folder.
std::vector<std::string> files_of_logs(const IdentifyArguments& options) {
  std::vector<std::string> files;
  for (const std::string& log : options.logs) {
    std::error_code none;  // what is no folder is a log
    const fs::directory_iterator folder(log, none);
    if (none) files.push_back(log);
    for (const fs::directory_entry& entry : folder) {
      if (entry.path().extension() == ".csv") files.push_back(entry.path().string());
    }
  }
  return files;
}

// The robot file that --robot names may be replaced by the one of --out: it is what is known then.
void check_files_to_write(const IdentifyArguments& options) {
  const fs::path report = report_file(options);
  if (!options.out.empty() && fs::path(options.out).lexically_normal() == report.lexically_normal()) {
    throw InputError(options.report.empty() ? "--out" : "--report", "",
                     fmt::format("{} would be both the robot and the report", report.string()));
  }
  std::vector<std::string> inputs = files_of_logs(options);
  refuse_to_overwrite("--out", options.out, inputs);
  inputs.push_back(options.robot);
  refuse_to_overwrite("--report", report_file(options), inputs);
  refuse_another_kind("--out", options.out, ".yaml");
  refuse_another_kind("--report", report_file(options).string(), ".html");
}

int run(const IdentifyArguments& options) {
  check_files_to_write(options);
  if (options.name == "executed") return run_executed(options);
  if (options.widen != 1) throw InputError("--widen", "", "is for `identify executed` alone");
  if (options.payload_known) throw InputError("--payload-known", "", "is for `identify executed` alone");
  const fs::path base = options.robot.empty() ? default_robot_file() : fs::path(options.robot);
  const Parameters robot = load_bare_parameters(base);
  const Identification found = identify_as_asked(options, robot);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Estimate& e : found.estimates) {
    if (options.json) {
      json.push_back(json_of(e));
    } else {
      say_in(stdout, "{}", text_of(e));
    }
  }
  if (!options.json) {
    say_in(stdout, "{}{}", combined_text(combine_repeated(found.estimates)), consistency_table(found.agreements));
  }
  tell_doubts(found.agreements, found.changes);
  const fs::path report = report_file(options);
  if (!report.empty()) write_file(report, format_identification_report(found.estimates, found.changes));
  if (!options.accept_inconsistent) refuse_contradictions(found, options.logs.front());
  if (!options.out.empty()) tell_doubts(write_robot(options.out, base, robot, found, options.link_damping));
  if (options.json) {  // last, because if something is refused, the reason has to be the only JSON
    fmt::print("{}", json_text(json));
  } else {
    fmt::print("{}{}{}\n", options.out, options.out.empty() ? "" : " ", report.string());
  }
  return 0;
}

}  // namespace

void add_identify(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<IdentifyArguments>();
  CLI::App* command = app.add_subcommand("identify", "Identify parameters from logs and write robot.yaml");
  std::vector<std::string> names = procedure_names();
  names.emplace_back("all");
  names.emplace_back("executed");
  command
      ->add_option("name", options->name,
                   "Procedure: stiffness, gravity, ..., or all over a folder of logs; executed: all that the "
                   "executor's logs of ordinary motions tell")
      ->required()
      ->check(one_of(names));
  command->add_option("logs", options->logs, "Logs, or the folder of <experiment>_<joint>.csv")
      ->required()
      ->type_name("LOG.csv...|DIR");
  command->add_option("--out", options->out, "Write a complete robot.yaml")
      ->type_name("robot.yaml")
      ->check(file_to_write());
  command
      ->add_option("--report", options->report,
                   "Write plots of fits and residuals; of all to the --out name with .html")
      ->type_name("REPORT.html")
      ->check(file_to_write());
  command->add_option("--robot", options->robot, "What is known so far; without it the robot.yaml shipped with fjr");
  command->add_option("--joint", options->joint, "Joint of the logs, where they do not say")->check(CLI::Range(1, 2));
  command->add_option("--column", options->columns, "Column name in the logs, as in q1=link_1_position")
      ->type_name("OURS=THEIRS")
      ->expected(1)
      ->take_all();
  command->add_flag("--link-damping", options->link_damping, "Write the identified link damping as the model's");
  command->add_flag("--accept-inconsistent", options->accept_inconsistent,
                    "Write robot.yaml even where two logs contradict each other");
  command
      ->add_option("--widen", options->widen,
                   "Of executed: take the standard errors of the robot file for so many times as large")
      ->check(between(1, 1000))
      ->type_name("TIMES");
  command->add_flag("--payload-known", options->payload_known,
                    "Of executed: the mass at the tip is as in the robot file, and not to be found");
  command->add_flag("--json", options->json, "Only JSON on stdout");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
