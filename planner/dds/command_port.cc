#include "planner/dds/command_port.h"

#include <utility>

#include "planner/dds/wire_execution.h"

namespace fjr::dds {

// The writer is created first, so that a command can be sent as soon as a reader is discovered.
CommandPort::CommandPort(Participant participant)
    : participant_(std::move(participant)),
      waitset_(participant_),
      commands_(participant_, participant_.handle()),
      executors_(participant_),
      discovery_(participant_) {
  checked(dds_set_status_mask(commands_.handle(), DDS_PUBLICATION_MATCHED_STATUS), "status mask");
  waitset_.attach(commands_.handle());
}

bool CommandPort::send(const ExecutorOrder& order) { return commands_.write(encode(order)); }

bool CommandPort::reports_states(const Discovery::Peer& peer) {
  return peer.writes.contains(TopicOf<fjr_msg_ExecutorState>::kName);
}

bool CommandPort::takes_commands(const Discovery::Peer& peer) {
  return peer.reads.contains(TopicOf<fjr_msg_ExecutorCommand>::kName);
}

}  // namespace fjr::dds
