// How the service is doing, as Prometheus reads it: text in its exposition format, version 0.0.4.
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
  std::optional<ExecutorState> executor;  // none: nobody is heard
  std::size_t remembered = 0;             // replies
  Clock::time_point now = Clock::now();
};

// Of one service, or of several in one process, each sample then with its robot_id; none: of one nothing is known yet.
std::string metrics_text(const std::vector<std::optional<Metrics>>& services);

}  // namespace fjr
