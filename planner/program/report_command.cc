// fjr report: an HTML page about a plan that lies in a folder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "planner/program/commands.h"
#include "planner/program/result_files.h"
#include "planner/results/report/plan_files.h"
#include "planner/results/result_folder.h"

namespace fjr {

void add_report(CLI::App& app, int& exit_code) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "Write DIR/report.html about a plan: animation, plots, certificate");
  command->add_option("folder", *folder, "Folder of a plan: fjr plan or fjr request wrote it")
      ->required()
      ->type_name("DIR");
  command->callback([folder, &exit_code] {
    const FolderLock lock(*folder);
    fmt::print("{}\n", write_report(*folder).string());
    exit_code = 0;
  });
}

}  // namespace fjr
