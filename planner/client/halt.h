// Holding or stopping an executor from elsewhere, and seeing that it did.
#pragma once

#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/network.h"

namespace fjr {

struct HaltOptions {
  Network network;
  std::string robot_id = "arm";
  double find = 3;     // [s] to hear an executor of the robot, since somebody was last met
  double comply = 10;  // [s] for the arm to come to rest
};

// Sends the command to whoever takes commands, as soon as they are met and again until it is over, whether anything is
// heard of them or not. Returns the states in which every executor of the robot holds, or is stopped. Throws NoAnswer
// (planner/client/client.h), one sentence on what was sent and who has not said so.
std::vector<ExecutorState> halt(ExecutorCommand command, const HaltOptions& options);

}  // namespace fjr
