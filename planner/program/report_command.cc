// fjr report: writes an HTML page about a plan in a folder, or about two plans.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "planner/program/altered.h"
#include "planner/program/commands.h"
#include "planner/program/file_checks.h"
#include "planner/program/result_files.h"
#include "planner/results/report/both_plans_page.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/report/plan_record.h"
#include "planner/results/result_folder.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out;  // empty: in the first folder
};

void check_report_to_write(const fs::path& file) {
  const std::string fault = fault_of_file_to_write(file.string());
  if (fs::is_directory(file.parent_path()) && !fault.empty()) throw InputError(file.parent_path().string(), "", fault);
}

fs::path report_on_one(const ReportArguments& options) {
  if (!options.out.empty()) throw InputError("--out", "", "is for two plans; of one, report.html is in its folder");
  check_report_to_write(fs::path(options.folders[0]) / "report.html");
  const FolderLock lock(options.folders[0]);
  const fs::path file = write_report(options.folders[0]);
  warn_if_altered(options.folders[0], read_plan(options.folders[0]));
  return file;
}

// Folders are locked one after the other: two locks in one parent folder would wait for each other.
PlanRecord plan_in(const fs::path& folder) {
  const FolderLock lock(folder);
  PlanRecord plan = read_plan(folder);
  warn_if_altered(folder, plan);
  return plan;
}

fs::path report_on_two(const ReportArguments& options) {
  const fs::path first = options.folders[0], second = options.folders[1];
  std::error_code error;
  if (fs::equivalent(first, second, error)) throw InputError(options.folders[1], "", "is the same folder twice");
  const fs::path file = options.out.empty() ? first / "compared.html" : fs::path(options.out);
  check_report_to_write(file);
  refuse_another_kind("--out", file.string(), ".html");
  const PlanRecord one = plan_in(first), other = plan_in(second);
  write_file(file, reading(one.source + ", " + other.source, [&] { return both_plans_page(one, other); }));
  return file;
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand(
      "report", "Write DIR/report.html about a plan: animation, plots, certificate; of two, one over the other");
  command
      ->add_option("folders", options->folders,
                   "Folder of a plan: fjr plan or fjr request wrote it; or two of them, to be compared")
      ->required()
      ->expected(1, 2)
      ->type_name("DIR [DIR]");
  command->add_option("--out", options->out, "Page about two plans; default: compared.html in the first folder")
      ->type_name("FILE")
      ->check(file_to_write());
  command->callback([options, &exit_code] {
    const fs::path file = options->folders.size() == 1 ? report_on_one(*options) : report_on_two(*options);
    fmt::print("{}\n", file.string());
    exit_code = 0;
  });
}

}  // namespace fjr
