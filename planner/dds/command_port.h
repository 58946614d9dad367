// The protocol side of programs that hold or stop an executor.
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

  // Waits; ends at once when a new reader of commands is discovered.
  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  std::size_t readers() const { return commands_.readers(); }  // of commands, known by now: send() is for them
  bool send(const ExecutorOrder& order);
  bool delivered() const { return commands_.flush(0); }  // whether they have acknowledged all commands

  // Returns whether the participant has a writer of states, even if it is not compatible with this program.
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
