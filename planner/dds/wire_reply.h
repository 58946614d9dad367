// Replies, progress and the service's state on the wire.
#pragma once

#include <fjr_msgs.h>

#include "planner/protocol/messages.h"

namespace fjr::dds {

// Points into `reply`, which must outlive the message; nothing is copied.
fjr_msg_PlanReply encode(const Reply& reply);

// A reply of SOLVED without a trajectory, or with numbers that are not finite, has failed: kNoTrajectory.
Reply decode(const fjr_msg_PlanReply& message);

fjr_msg_PlanStatus encode(const ProgressReport& report);
ProgressReport decode(const fjr_msg_PlanStatus& message);

fjr_msg_PlannerStatus encode(const ServiceStatus& status);
ServiceStatus decode(const fjr_msg_PlannerStatus& message);

}  // namespace fjr::dds
