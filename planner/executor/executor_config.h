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
  std::filesystem::path robot;  // what trajectories must have been planned for
  std::filesystem::path state;  // folder of what it remembers over restarts
  std::filesystem::path logs;   // folder of the logs of executions; empty: none
  int priority = 80;            // of the control tick, 1 to 99; 0: an ordinary thread
  double oldest = 10;           // [s] since a trajectory was published
  Tolerances tolerances{{0.02, 0.02}, {0.005, 0.005}, 0.5, {0.05, 0.05}};  // for trajectories that name none
  bool fast = false;  // while something moves, ticks follow each other without waiting for the clock

  Joints<double> start{};            // [rad] where the simulated links rest at first
  std::filesystem::path true_robot;  // what the simulated arm really is; empty: robot
  VirtualArmOptions arm;             // without `truth`
};

// The defaults, with the robot shipped with the program.
ExecutorConfig default_executor_config();

// Throws InputError naming file, field, value and what is allowed.
ExecutorConfig load_executor_config(const std::filesystem::path& file);

// Where a program keeps what it has to remember: $STATE_DIRECTORY, $XDG_STATE_HOME/fjr or ~/.local/state/fjr. Throws
// InputError when there is none of them.
std::filesystem::path default_state_folder();

}  // namespace fjr
