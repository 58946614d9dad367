// The side of the protocol of who halts an executor.
#pragma once

#include <chrono>
#include <vector>

#include "planner/service/dds/participant.h"
#include "planner/service/dds/reader.h"
#include "planner/service/dds/waitset.h"
#include "planner/service/dds/writer.h"
#include "planner/service/execution_messages.h"

namespace fjr::dds {

class CommandPort {
 public:
  explicit CommandPort(Participant participant);

  void wait(std::chrono::nanoseconds timeout) { waitset_.wait(timeout); }

  bool heard() const { return commands_.has_reader(); }  // some executor takes commands
  bool send(const ExecutorOrder& order);
  std::vector<ExecutorState> take_states();

 private:
  Participant participant_;
  Waitset waitset_;
  Reader<fjr_msg_ExecutorState> states_;
  Writer<fjr_msg_ExecutorCommand> commands_;
};

}  // namespace fjr::dds
