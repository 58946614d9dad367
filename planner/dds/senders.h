// Who writes requests: the DDS participants behind the writers that the service's readers have met.
#pragma once

#include <dds/dds.h>

#include <map>
#include <set>
#include <vector>

#include "planner/protocol/messages.h"

namespace fjr::dds {

class Senders {
 public:
  // Of a sample that `reader` took, by its publication handle. A writer that is gone by now is a sender of its own.
  Origin origin(dds_entity_t reader, dds_instance_handle_t writer);

  // Takes notice of who has left the readers.
  void look(const std::vector<dds_entity_t>& readers);

  // Until its end, or the lease of its participant, is noticed.
  bool present(const Origin& origin) const { return present_.contains(origin); }

 private:
  std::map<dds_instance_handle_t, Origin> writers_;
  std::set<Origin> present_;
};

}  // namespace fjr::dds
