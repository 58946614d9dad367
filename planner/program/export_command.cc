// fjr export: plans and logs for other programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
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

std::string suffix_of(const std::string& format) { return format == "ros2" ? ".ros2.mcap" : "." + format; }

fs::path file_of(const ExportArguments& options, bool folder) {
  if (!options.out.empty()) return options.out;
  const fs::path input = options.input;
  return folder ? input / ("export" + suffix_of(options.format))
                : fs::path(input).replace_extension(".export" + suffix_of(options.format));
}

void check_ticks(const PlanRecord& plan, double tick) {
  const double ticks = (plan.trajectory->end_time() - plan.trajectory->start_time()) / tick;
  if (ticks > static_cast<double>(kMostTicks)) {
    throw InputError("--tick", "",
                     fmt::format("{} s makes {:.0f} rows of this plan, above {}", tick, ticks, kMostTicks));
  }
}

void write(const ExportArguments& options, const Exported& exported, const fs::path& file) {
  const auto table = [&] {
    return exported.plan != nullptr ? table_of(exported.plan->robot, *exported.ticked) : table_of(*exported.log);
  };
  if (options.format == "csv") return write_file(file, as_csv(table()));
  if (options.format == "mat") return write_mat(exported, table(), file);
  write_file(file, options.format == "mcap" ? as_mcap(exported) : as_ros2(exported));
}

int run(const ExportArguments& options) {
  std::error_code error;
  const bool folder = fs::is_directory(options.input, error);
  if (!folder && options.format == "ros2") {
    throw InputError("--format", "", "ros2 is for plans: give the folder of one");
  }
  if (!options.log.empty() && (!folder || options.format != "mcap")) {
    throw InputError("--log", "", "goes with the folder of a plan and the format mcap; a log alone is given by itself");
  }
  const fs::path file = file_of(options, folder);
  if (const std::string fault = fault_of_file_to_write(file.string()); fs::exists(options.input) && !fault.empty()) {
    throw InputError("--out", "", fault);
  }
  std::optional<PlanRecord> plan;
  Exported exported;
  if (folder) {
    const FolderLock lock(options.input);
    plan = read_plan(options.input);
    if (!plan->trajectory) throw InputError(plan->source, "", "has no trajectory: there is nothing to export");
    check_ticks(*plan, options.tick);
    exported.plan = &*plan;
    exported.ticked = at_ticks(plan->robot, *plan->trajectory, options.tick);
    if (!options.log.empty()) exported.log = read_log(options.log);
  } else {
    exported.log = read_log(options.input);
  }
  if (!options.joint_names.empty()) exported.joint_names = {options.joint_names[0], options.joint_names[1]};
  const auto write_it = [&] { write(options, exported, file); };
  plan ? reading(plan->source, write_it) : write_it();
  fmt::print("{}\n", file.string());
  return 0;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ExportArguments>();
  CLI::App* command =
      app.add_subcommand("export", "Write a plan or a log for other programs: CSV, MATLAB, MCAP, ROS 2");
  command->add_option("input", options->input, "Folder of a plan, or a log of the executor or the rig")
      ->required()
      ->type_name("DIR|LOG.csv");
  command
      ->add_option("--format", options->format,
                   "csv: columns with units, nothing else; mat: MATLAB; mcap: Foxglove, PlotJuggler; ros2: "
                   "trajectory_msgs/JointTrajectory in MCAP")
      ->required()
      ->check(one_of({"csv", "mat", "mcap", "ros2"}));
  command
      ->add_option("--tick", options->tick,
                   "Period of the drive, in seconds: the rows of a plan, and their mean torques")
      ->check(between(kShortestTick, kLongestTick))
      ->capture_default_str();
  command->add_option("--log", options->log, "Log of the plan's execution, into the same MCAP file")
      ->type_name("LOG.csv");
  command->add_option("--joint-names", options->joint_names, "Of ros2; default: joint1,joint2")
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
