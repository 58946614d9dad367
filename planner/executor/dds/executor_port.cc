#include "planner/executor/dds/executor_port.h"

#include <utility>

#include "planner/service/dds/wire_execution.h"

namespace fjr::dds {

ExecutorPort::ExecutorPort(Participant participant)
    : participant_(std::move(participant)),
      waitset_(participant_),
      trajectories_(participant_, participant_.handle()),
      commands_(participant_, participant_.handle()),
      state_(participant_, participant_.handle()),
      results_(participant_, participant_.handle()) {
  waitset_.attach(trajectories_.arrived());
  waitset_.attach(commands_.arrived());
}

std::vector<TrajectoryOrder> ExecutorPort::take_trajectories() {
  std::vector<TrajectoryOrder> orders;
  trajectories_.take_all([&](const fjr_msg_Trajectory& message, const dds_sample_info_t& info) {
    if (info.valid_data) orders.push_back(decode(message));
  });
  return orders;
}

std::vector<ExecutorOrder> ExecutorPort::take_commands() {
  std::vector<ExecutorOrder> orders;
  commands_.take_all([&](const fjr_msg_ExecutorCommand& message, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    if (auto order = decode(message)) orders.push_back(std::move(*order));
  });
  return orders;
}

void ExecutorPort::send(const ExecutorState& state) { (void)state_.write(encode(state)); }

void ExecutorPort::send(const ExecutionResult& result) { (void)results_.write(encode(result).message); }

}  // namespace fjr::dds
