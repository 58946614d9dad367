#include "planner/executor/dds/command_port.h"

#include <utility>

#include "planner/service/dds/wire_execution.h"

namespace fjr::dds {

CommandPort::CommandPort(Participant participant)
    : participant_(std::move(participant)),
      waitset_(participant_),
      states_(participant_, participant_.handle()),
      commands_(participant_, participant_.handle()) {
  waitset_.attach(states_.arrived());
}

bool CommandPort::send(const ExecutorOrder& order) { return commands_.write(encode(order)); }

std::vector<ExecutorState> CommandPort::take_states() {
  std::vector<ExecutorState> states;
  states_.take_all([&](const fjr_msg_ExecutorState& message, const dds_sample_info_t& info) {
    if (info.valid_data) states.push_back(decode(message));
  });
  return states;
}

}  // namespace fjr::dds
