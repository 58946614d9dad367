// The executor's side of the protocol. Nothing here waits: it is called from the control tick.
#pragma once

#include <vector>

#include "planner/service/dds/participant.h"
#include "planner/service/dds/reader.h"
#include "planner/service/dds/writer.h"
#include "planner/service/execution_messages.h"

namespace fjr::dds {

class ExecutorPort {
 public:
  explicit ExecutorPort(unsigned domain);

  std::vector<TrajectoryOrder> take_trajectories();
  void send(const ExecutorState& state);
  void send(const ExecutionResult& result);

 private:
  Participant participant_;
  Reader<fjr_msg_Trajectory> trajectories_;
  Writer<fjr_msg_ExecutorState> state_;
  Writer<fjr_msg_ExecutionResult> results_;
};

}  // namespace fjr::dds
