// fjr executor: the virtual hardware.
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "model/input_error.h"
#include "planner/executor/executor.h"
#include "planner/executor/virtual_arm.h"
#include "planner/program/commands.h"
#include "planner/program/ending.h"
#include "planner/program/service_log.h"

namespace fjr {
namespace {

struct Options {
  std::string robot;  // empty: the default
  std::vector<double> start{0, 0};
  ExecutorConfig executor;
};

Pair<double> start_of(const Options& options, const Parameters& robot) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(std::abs(options.start[j]) <= robot.limits.link_position[j])) {
      throw InputError("--start", "q" + std::to_string(j + 1), "is outside the robot's limits");
    }
  }
  return {options.start[0], options.start[1]};
}

int execute(const Options& options) {
  block_ending_signals();  // before any other thread is started
  log_to_stderr();
  const Parameters robot =
      load_parameters(options.robot.empty() ? default_robot_file() : std::filesystem::path(options.robot));
  VirtualArm arm(robot, start_of(options, robot));
  Executor executor(options.executor, robot, arm);
  const std::jthread ending = stop_at_end(executor);
  executor.run();
  return 0;
}

}  // namespace

void add_executor(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("executor", "Run received trajectories on the simulated arm, until SIGTERM");
  command->add_option("--robot", options->robot, "Robot file; without it the one shipped with fjr")->type_name("R");
  command->add_option("--start", options->start, "Where the links rest at first, in rad")
      ->delimiter(',')
      ->expected(2)
      ->type_name("Q1,Q2");
  command->add_option("--robot-id", options->executor.robot_id, "Name of the arm on DDS")->capture_default_str();
  command->add_option("--domain", options->executor.domain, "DDS domain")->check(CLI::Range(0, 230));
  command->add_flag("--fast", options->executor.fast, "Execute as fast as the simulation can instead of in real time");
  command->callback([options, &exit_code] { exit_code = execute(*options); });
}

}  // namespace fjr
