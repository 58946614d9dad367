// Replies, progress and the service's state on the wire.
#pragma once

#include <fjr_msgs.h>

#include "planner/protocol/messages.h"

namespace fjr::dds {

// The message points into `reply`, which must outlive it; nothing is copied.
fjr_msg_PlanReply encode(const Reply& reply);

// A reply SOLVED without a trajectory, or with numbers that are not finite, is decoded as a failure with kNoTrajectory.
Reply decode(const fjr_msg_PlanReply& message);

fjr_msg_PlanStatus encode(const ProgressReport& report);
ProgressReport decode(const fjr_msg_PlanStatus& message);

fjr_msg_PlannerStatus encode(const ServiceStatus& status);
ServiceStatus decode(const fjr_msg_PlannerStatus& message);

}  // namespace fjr::dds
