// Tracks the DDS participants that send requests, by the writers matched to the service's readers.
#pragma once

#include <dds/dds.h>

#include <map>
#include <set>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr::dds {

class Senders {
 public:
  // Returns the participant that sent a sample, by its publication handle. A writer that is already gone counts as a
  // participant of its own.
  Origin origin(dds_entity_t reader, dds_instance_handle_t writer);

  // Updates which participants are no longer matched to the readers.
  void look(const std::vector<dds_entity_t>& readers);

  // Returns true until DDS notices that the participant has ended or its lease has expired.
  bool present(const Origin& origin) const { return present_.contains(origin); }

 private:
  std::map<dds_instance_handle_t, Origin> writers_;
  std::set<Origin> present_;
};

}  // namespace fjr::dds
