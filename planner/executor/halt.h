// Holding or stopping an executor from elsewhere, and seeing that it did.
#pragma once

#include <string>

#include "planner/service/execution_messages.h"
#include "planner/service/network.h"

namespace fjr {

struct HaltOptions {
  Network network;
  std::string robot_id = "arm";
  double find = 3;     // [s] to find the executor
  double comply = 10;  // [s] for the arm to come to rest
};

// The state in which the executor holds, or is stopped. Throws NoAnswer (planner/service/client.h), one sentence: no
// executor, or it does not comply.
ExecutorState halt(ExecutorCommand command, const HaltOptions& options);

}  // namespace fjr
