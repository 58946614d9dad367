// The side of the protocol of who halts an executor.
#pragma once

#include <chrono>
#include <vector>

#include "planner/dds/discovery.h"
#include "planner/dds/executor_states.h"
#include "planner/dds/participant.h"
#include "planner/dds/waitset.h"
#include "planner/dds/writer.h"
#include "planner/protocol/execution_messages.h"

namespace fjr::dds {

class CommandPort {
 public:
  explicit CommandPort(Participant participant);

  // Ends at once when somebody takes commands who did not before.
  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  std::size_t readers() const { return commands_.readers(); }  // of commands, known by now: send() is for them
  bool send(const ExecutorOrder& order);
  bool delivered() const { return commands_.flush(0); }  // they have acknowledged what was sent

  // To all appearance, whether it and this program understand each other or not.
  static bool reports_states(const Discovery::Peer& peer);
  static bool takes_commands(const Discovery::Peer& peer);

  ExecutorStates& executors() { return executors_; }
  Discovery& discovery() { return discovery_; }

 private:
  Participant participant_;
  Waitset waitset_;
  Writer<fjr_msg_ExecutorCommand> commands_;
  ExecutorStates executors_;
  Discovery discovery_;
};

}  // namespace fjr::dds
