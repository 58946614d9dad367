// fjr executor: the virtual hardware.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/degrees.h"
#include "common/input_error.h"
#include "planner/executor/executor.h"
#include "planner/executor/virtual_arm.h"
#include "planner/program/commands.h"
#include "planner/program/ending.h"
#include "planner/program/file_checks.h"
#include "planner/program/network_arguments.h"
#include "planner/program/number_checks.h"
#include "planner/program/service_log.h"

namespace fjr {
namespace {

struct ExecutorArguments {  // the command line takes precedence over the configuration
  std::string config, robot, true_robot, robot_id, state, logs;
  NetworkArguments network;
  std::vector<double> start;
  double payload = 0;
  bool hysteresis = false, fast = false;
};

ExecutorConfig config_of(const ExecutorArguments& options) {
  ExecutorConfig config = options.config.empty() ? default_executor_config() : load_executor_config(options.config);
  if (!options.robot.empty()) config.robot = options.robot;
  if (!options.true_robot.empty()) config.true_robot = options.true_robot;
  if (options.robot_id.size() > kLongestName) {
    throw InputError("command line", "--robot-id",
                     fmt::format("{} characters, above the {} allowed", options.robot_id.size(), kLongestName));
  }
  if (!options.robot_id.empty()) config.robot_id = options.robot_id;
  if (!options.state.empty()) config.state = options.state;
  if (!options.logs.empty()) config.logs = options.logs;
  options.network.apply_to(config.network);
  if (!options.start.empty()) config.start = {options.start[0], options.start[1]};
  if (options.payload > 0) config.arm.payload = options.payload;
  if (options.hysteresis) config.arm.hysteresis = Hysteresis{};
  config.fast = options.fast;
  return config;
}

void check_start(const ExecutorConfig& config, const Parameters& robot) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double lowest = robot.lowest(j), highest = robot.highest(j);
    if (config.start[j] >= lowest && config.start[j] <= highest) continue;
    throw InputError("executor", fmt::format("start.q[{}]", j),
                     fmt::format("{} rad is outside [{}, {}]{}", config.start[j], lowest, highest,
                                 degrees_suspected(config.start[j], lowest, highest)));
  }
}

int execute(const ExecutorArguments& options) {
  catch_ending_signals();  // before any other thread is started
  const auto log = log_to_stderr();
  const ExecutorConfig config = config_of(options);
  const Parameters robot = load_parameters(config.robot);
  check_start(config, robot);
  if (!config.logs.empty()) make_writable_folder("logs", config.logs);
  if (!config.state.empty()) make_writable_folder("state", config.state);
  VirtualArmOptions really = config.arm;
  really.truth = config.true_robot.empty() ? robot : load_parameters(config.true_robot);
  VirtualArm arm(really, config.start);
  Executor executor(config, robot, arm);
  const std::jthread ending = stop_at_end(executor);
  executor.run();
  return 0;
}

}  // namespace

void add_executor(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ExecutorArguments>();
  CLI::App* command = app.add_subcommand("executor", "Run received trajectories on the simulated arm, until SIGTERM");
  command->add_option("--config", options->config, "Configuration; without it the defaults")
      ->type_name("EXECUTOR.yaml");
  command->add_option("--robot", options->robot, "Robot file; without it the one shipped with fjr")->type_name("R");
  command->add_option("--start", options->start, "Where the links rest at first, in rad")
      ->check(finite())
      ->delimiter(',')
      ->expected(2)
      ->type_name("Q1,Q2");
  command->add_option("--robot-id", options->robot_id, "Name of the arm on DDS")->type_name("NAME");
  add_network_options(*command, options->network);
  command->add_option("--logs", options->logs, "Folder for a log of every execution")->type_name("DIR");
  command->add_option("--state", options->state, "Folder of what is remembered over restarts")->type_name("DIR");
  command->add_option("--true-robot", options->true_robot, "What the simulated arm really is: another robot file")
      ->type_name("R");
  command->add_option("--payload", options->payload, "Mass at the tip that nobody planned with, in kg")
      ->check(between(0, 10))
      ->type_name("KG");
  command->add_flag("--hysteresis", options->hysteresis, "Springs with the hysteresis of `fjr experiment`");
  command->add_flag("--fast", options->fast, "Execute as fast as the simulation can instead of in real time");
  command->callback([options, &exit_code] { exit_code = execute(*options); });
}

}  // namespace fjr
