// executor.yaml: how `fjr executor` runs.
#pragma once

#include <filesystem>
#include <string>

#include "planner/executor/virtual_arm.h"
#include "planner/protocol/execution_messages.h"
#include "planner/protocol/network.h"

namespace fjr {

struct ExecutorConfig {
  Network network;
  std::string robot_id = "arm";
  std::filesystem::path robot;  // robot.yaml that trajectories must have been planned for
  std::filesystem::path state;  // folder of the history, which is kept over restarts
  std::filesystem::path logs;   // folder of the logs of executions; empty: none
  int priority = 80;            // of the control tick, 1 to 99; 0: an ordinary thread
  double oldest = 10;           // [s] largest accepted age of a trajectory since it was published
  Tolerances tolerances{{0.02, 0.02}, {0.005, 0.005}, 0.5, {0.05, 0.05}};  // for trajectories that name none
  bool fast = false;  // while something moves, ticks follow each other without waiting for the clock

  Joints<double> start{};            // [rad] where the simulated links rest at first
  std::filesystem::path true_robot;  // robot.yaml of the simulated arm; empty: `robot`
  VirtualArmOptions arm;             // without `truth`
};

// Returns the defaults, with the robot file that is shipped with the program.
ExecutorConfig default_executor_config();

// Throws InputError naming file, field, value and what is allowed.
ExecutorConfig load_executor_config(const std::filesystem::path& file);

// Returns the default folder for persistent state: $STATE_DIRECTORY, $XDG_STATE_HOME/fjr or $HOME/.local/state/fjr.
// Throws InputError if none of these environment variables is set.
std::filesystem::path default_state_folder();

}  // namespace fjr
