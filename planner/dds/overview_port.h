// The protocol side of observers. It has no writers, so that DDS Security can permit it to participants that may only
// read.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "planner/dds/discovery.h"
#include "planner/dds/executor_states.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/protocol/execution_messages.h"
#include "planner/protocol/messages.h"

namespace fjr::dds {

class OverviewPort {
 public:
  explicit OverviewPort(Participant participant);

  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  std::vector<ServiceStatus> take_services();  // the latest word of each
  std::vector<ExecutorStates::Heard> take_executors() { return executors_.take(); }
  std::vector<ArmDrift> take_drifts();  // the latest word of each robot's executor
  Discovery& discovery() { return discovery_; }

 private:
  Participant participant_;
  Waitset waitset_;
  Discovery discovery_;
  Reader<fjr_msg_PlannerStatus> services_;
  ExecutorStates executors_;
  std::optional<Reader<fjr_msg_ArmDrift>> drifts_;
};

}  // namespace fjr::dds
