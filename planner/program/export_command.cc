// fjr export: plans and logs for other programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/input_error.h"
#include "planner/program/altered.h"
#include "planner/program/commands.h"
#include "planner/program/file_checks.h"
#include "planner/program/misspelt.h"
#include "planner/program/number_checks.h"
#include "planner/results/export/formats.h"
#include "planner/results/result_folder.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr double kShortestTick = 1e-4, kLongestTick = 0.1;  // [s]
constexpr std::size_t kMostTicks = 2'000'000;

struct ExportArguments {
  std::string input;  // the folder of a plan, or a log
  std::string log;    // beside a plan
  std::string format, out;
  double tick = 0.001;  // [s]
  std::vector<std::string> joint_names;
};

using Member = std::string_view ExportFormat::*;

const auto kEvery = [](const ExportFormat&) { return true; };

// Returns this member of all chosen formats: "csv", "mat", ...
template <class Chosen>
std::vector<std::string> list_of(Member member, const Chosen& chosen) {
  std::vector<std::string> list;
  for (const ExportFormat& format : export_formats()) {
    if (std::invoke(chosen, format)) list.emplace_back(format.*member);
  }
  return list;
}

template <class Chosen>
std::string joined(Member member, const Chosen& chosen) {
  return fmt::format("{}", fmt::join(list_of(member, chosen), ", "));
}

// Returns the meanings of all formats: "csv: columns with units, nothing else; mat: MATLAB; ..."
std::string meanings() {
  std::vector<std::string> all;
  for (const ExportFormat& format : export_formats()) all.push_back(fmt::format("{}: {}", format.name, format.meaning));
  return fmt::format("{}", fmt::join(all, "; "));
}

// Returns the format of that name, which --format has been checked for.
const ExportFormat& format_named(std::string_view name) {
  const auto all = export_formats();
  return *std::find_if(all.begin(), all.end(), [&](const ExportFormat& format) { return format.name == name; });
}

fs::path file_of(const ExportArguments& options, const ExportFormat& format, bool folder) {
  if (!options.out.empty()) return options.out;
  const fs::path input = options.input;
  return folder ? input / fmt::format("export{}", format.suffix)
                : fs::path(input).replace_extension(fmt::format(".export{}", format.suffix));
}

Joints<std::string> checked_names(const ExportArguments& options, const ExportFormat& format) {
  Joints<std::string> names{options.joint_names[0], options.joint_names[1]};
  if (!format.has_joint_names) {
    throw InputError("--joint-names", "", fmt::format("--format {} has no names of joints", format.name));
  }
  if (names[0] == names[1]) throw InputError("--joint-names", "", "the two names are the same");
  return names;
}

void check_ticks(const PlanRecord& plan, double tick) {
  const double ticks = (plan.trajectory->end_time() - plan.trajectory->start_time()) / tick;
  if (ticks > static_cast<double>(kMostTicks)) {
    throw InputError("--tick", "",
                     fmt::format("{} s makes {:.0f} rows of this plan, above {}", tick, ticks, kMostTicks));
  }
}

int run(const ExportArguments& options) {
  std::error_code error;
  const bool folder = fs::is_directory(options.input, error);
  const ExportFormat& format = format_named(options.format);
  if (!folder && !format.of_log_alone) {
    throw InputError("--format", "", fmt::format("{} is for plans: give the folder of one", format.name));
  }
  if (!options.log.empty() && (!folder || !format.log_beside_plan)) {
    throw InputError("--log", "",
                     fmt::format("goes with the folder of a plan and the format {}; a log alone is given by itself",
                                 joined(&ExportFormat::name, &ExportFormat::log_beside_plan)));
  }
  const fs::path file = file_of(options, format, folder);
  if (const std::string fault = fault_of_file_to_write(file.string()); fs::exists(options.input) && !fault.empty()) {
    throw InputError("--out", "", fault);
  }
  refuse_to_overwrite("--out", file, {options.input, options.log});
  refuse_another_kind("--out", file.string(), format.suffix.substr(format.suffix.rfind('.')));
  std::optional<FolderLock> lock;  // until the file is written: it belongs to the plan in the folder
  std::optional<PlanRecord> plan;
  Exported exported;
  if (folder) {
    lock.emplace(options.input);
    plan = read_plan(options.input);
    if (!plan->trajectory) throw InputError(plan->source, "", "has no trajectory: there is nothing to export");
    check_ticks(*plan, options.tick);
    warn_if_altered(options.input, *plan);
    exported.plan = &*plan;
    exported.ticked = at_ticks(plan->robot, *plan->trajectory, options.tick);
    if (!options.log.empty()) exported.log = read_log(options.log);
  } else {
    exported.log = read_log(options.input);
  }
  if (!options.joint_names.empty()) exported.joint_names = checked_names(options, format);
  const auto write_it = [&] { format.write(exported, file); };
  plan ? reading(plan->source, write_it) : write_it();
  fmt::print("{}\n", file.string());
  return 0;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand(
      "export", fmt::format("Write a plan or a log for other programs: {}", joined(&ExportFormat::title, kEvery)));
  command->add_option("input", options->input, "Folder of a plan, or a log of the executor or the rig")
      ->required()
      ->type_name("DIR|LOG.csv");
  command->add_option("--format", options->format, meanings())
      ->required()
      ->check(one_of(list_of(&ExportFormat::name, kEvery)));
  command
      ->add_option("--tick", options->tick,
                   "Period of the drive, in seconds: the rows of a plan, and their mean torques")
      ->check(between(kShortestTick, kLongestTick))
      ->capture_default_str();
  command
      ->add_option("--log", options->log,
                   fmt::format("Log of the plan's execution, into the same {} file",
                               joined(&ExportFormat::title, &ExportFormat::log_beside_plan)))
      ->type_name("LOG.csv");
  command
      ->add_option(
          "--joint-names", options->joint_names,
          fmt::format("Of {}; default: joint1,joint2", joined(&ExportFormat::name, &ExportFormat::has_joint_names)))
      ->delimiter(',')
      ->expected(2)
      ->type_name("NAME,NAME");
  command
      ->add_option("--out", options->out,
                   "File to write; default: export.FORMAT in the folder, LOG.export.FORMAT beside the log")
      ->type_name("FILE")
      ->check(file_to_write());
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
