// Leases of work on the wire.
#pragma once

#include <fjr_work.h>

#include <vector>

#include "planner/protocol/work_messages.h"

namespace fjr::dds {

// A message together with the list it points to.
struct WireOffer {
  fjr_msg_WorkerOffer message{};
  std::vector<fjr_msg_HeldLease> held;
};
WireOffer encode(const WorkerOffer& offer);
WorkerOffer decode(const fjr_msg_WorkerOffer& message);

// The messages point into the arguments, which must outlive them.
fjr_msg_WorkLease encode(const LeaseWord& word);
LeaseWord decode(const fjr_msg_WorkLease& message);

// An impossible result (an unknown outcome or state, solved without rows, rows that are not finite) is decoded as lost
// work.
fjr_msg_WorkResult encode(const WorkResult& result);
WorkResult decode(const fjr_msg_WorkResult& message);

}  // namespace fjr::dds
