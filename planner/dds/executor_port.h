// The executor's side of the protocol.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "planner/dds/executor_states.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/claim.h"
#include "planner/protocol/execution_messages.h"

namespace fjr::dds {

class ExecutorPort {
 public:
  // The robot's name is announced with the writer of states, before the first of them.
  ExecutorPort(Participant participant, const std::string& robot_id);

  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  std::vector<TrajectoryOrder> take_trajectories();
  std::vector<ExecutorOrder> take_commands();

  // Executors of the same robot: this one, those that have announced themselves, and those that report states.
  Claimant self() const;
  std::vector<Claimant> announced() const;
  std::vector<Claimant> take_reporting();

  void send(const ExecutorState& state);
  void send(const ExecutionResult& result);
  bool send(const ExecutedRun& run);  // false: a reader is too slow
  void send(const ArmDrift& drift);

  // Waits until results and runs have been received, at most for the timeout each.
  void flush(std::chrono::nanoseconds timeout) const {
    (void)results_.flush(timeout.count());
    if (runs_) (void)runs_->flush(timeout.count());
  }

 private:
  bool also_writes_2(dds_instance_handle_t publication) const;

  const std::string robot_id_;
  Participant participant_;
  Waitset waitset_;
  Reader<fjr_msg_Trajectory2> trajectories_2_;
  Reader<fjr_msg_Trajectory> trajectories_;
  std::optional<Reader<fjr_msg_LearntTrajectory>> learnt_trajectories_;
  Reader<fjr_msg_ExecutorCommand> commands_;
  ExecutorStates others_;
  Writer<fjr_msg_ExecutorState> state_;
  Writer<fjr_msg_ExecutionResult> results_;
  std::optional<Writer<fjr_msg_ExecutedRun>> runs_;
  std::optional<Writer<fjr_msg_ArmDrift>> drift_;
};

}  // namespace fjr::dds
