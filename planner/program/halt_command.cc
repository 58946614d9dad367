// fjr hold and fjr stop: bring an executor's arm to rest by a controlled stop.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/client/halt.h"
#include "planner/program/commands.h"
#include "planner/program/network_arguments.h"
#include "planner/program/number_checks.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

struct HaltArguments {
  HaltOptions halt;
  NetworkArguments network;
  bool json = false;
};

bool stopped(const ExecutorState& state) { return state.mode == ExecutorMode::kStopped; }

nlohmann::ordered_json halted_json(const ExecutorState& state) {
  return {{"robot_id", state.robot_id}, {"mode", stopped(state) ? "stopped" : "holding"}, {"q", state.q}};
}

int run(ExecutorCommand command, const HaltArguments& options) {
  HaltOptions how = options.halt;
  options.network.apply_to(how.network);
  const std::vector<ExecutorState> executors = halt(command, how);
  if (options.json) {
    nlohmann::ordered_json json = halted_json(executors.front());
    for (const ExecutorState& state : executors) json["executors"].push_back(halted_json(state));
    fmt::print("{}", json_text(json));
    return 0;
  }
  for (const ExecutorState& state : executors) {
    fmt::print("{}: {} at q = ({:.4f}, {:.4f}) rad\n", state.robot_id,
               stopped(state) ? "stopped until the executor is restarted" : "holding", state.q[0], state.q[1]);
  }
  return 0;
}

void add(CLI::App& app, int& exit_code, ExecutorCommand what, const std::string& name, const std::string& does) {
  const auto options = std::make_shared<HaltArguments>();
  CLI::App* command = app.add_subcommand(name, does);
  command->add_option("--robot-id", options->halt.robot_id, "Name of the arm on DDS")->capture_default_str();
  add_network_options(*command, options->network);
  command->add_option("--find", options->halt.find, "How long to look for an executor, in seconds")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--within", options->halt.comply, "How long the arm may take to come to rest, in seconds")
      ->check(positive())
      ->capture_default_str();
  command->add_flag("--json", options->json,
                    "Only JSON on stdout: the first executor of the robot, and all of them in `executors`");
  command->callback([options, what, &exit_code] { exit_code = run(what, *options); });
}

}  // namespace

void add_hold(CLI::App& app, int& exit_code) {
  add(app, exit_code, ExecutorCommand::kHold, "hold",
      "Bring the executor's arm to rest by a controlled stop and hold it there");
}

void add_stop(CLI::App& app, int& exit_code) {
  add(app, exit_code, ExecutorCommand::kStop, "stop",
      "As hold, and have the executor refuse trajectories until it is restarted; not an emergency stop");
}

}  // namespace fjr
