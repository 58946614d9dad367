// Holds or stops an executor from another program, and verifies that it did.
#pragma once

#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/network.h"

namespace fjr {

struct HaltOptions {
  Network network;
  std::string robot_id = "arm";
  double find = 3;     // [s] to hear an executor of the robot, since any participant was last discovered
  double comply = 10;  // [s] for the arm to come to rest
};

// Sends the command to every subscriber of commands as soon as it is discovered, and repeats it until the end, even if
// nothing is heard of them. Returns the states in which every executor of the robot holds or is stopped. Throws
// NoAnswer (planner/client/client.h) with one sentence about what was sent and who has not confirmed it.
std::vector<ExecutorState> halt(ExecutorCommand command, const HaltOptions& options);

}  // namespace fjr
