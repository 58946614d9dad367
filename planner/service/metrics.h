// The metrics of the service as text in the exposition format of Prometheus, version 0.0.4.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "planner/protocol/execution_messages.h"
#include "planner/protocol/messages.h"
#include "planner/service/tally.h"

namespace fjr {

struct Metrics {
  using Clock = std::chrono::system_clock;

  ServiceStatus status;
  Tally tally;
  std::optional<ExecutorState> executor;  // empty: no executor is heard
  std::size_t remembered = 0;             // replies
  Clock::time_point now = Clock::now();
};

// Returns the metrics of one service, or of several in one process (each sample then has the label robot_id). An empty
// element is a service of which nothing is known yet.
std::string metrics_text(const std::vector<std::optional<Metrics>>& services);

}  // namespace fjr
