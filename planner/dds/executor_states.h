// The states that executors publish, separately for each executor, because two may claim one robot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/dds/discovery.h"
#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/protocol/execution_messages.h"

namespace fjr::dds {

class ExecutorStates {
 public:
  using Source = dds_instance_handle_t;  // identifies the writer

  struct Heard {
    Source source;
    ExecutorState state;
  };

  explicit ExecutorStates(const Participant& participant, const Qos& qos = TopicOf<fjr_msg_ExecutorState>::qos());

  dds_entity_t arrived() const { return reader_.arrived(); }
  std::vector<Heard> take();
  bool there(Source source) const { return peer(source).has_value(); }
  std::optional<Discovery::Key> peer(Source source) const;  // nothing if it is gone

  // Returns the participants that have a writer for this robot's states, even if they have not written any.
  std::vector<Discovery::Key> announced(const std::string& robot_id) const;

 private:
  Reader<fjr_msg_ExecutorState> reader_;
};

}  // namespace fjr::dds
