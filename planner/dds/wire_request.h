// Requests between their document (DESIGN 5.2) and the wire.
#pragma once

#include <fjr_plan_request.h>

#include <vector>

#include "planner/protocol/messages.h"
#include "planner/request/request.h"

namespace fjr::dds {

// A message together with the lists it points to.
struct WireRequest {
  fjr_msg_PlanRequest2 message{};
  std::vector<fjr_msg_ViaPoint> via;
  std::vector<fjr_msg_Disc> obstacles;
  std::vector<fjr_msg_Posture> path;
};

fjr_msg_RequestId encode(const RequestId& id);
RequestId decode(const fjr_msg_RequestId& id);

// For services of this version. Throws InputError for a document that is no YAML map or too long.
fjr_msg_MotionRequest encode(const Order& order);

// For earlier ones. Throws InputError for a document that has not the shape of a request; what it asks for is the
// service's to judge.
WireRequest encode_plan_request(const Order& order);
// Whether message.request says it all, so that services that know PlanRequest only can plan it.
bool fits_plan_request(const fjr_msg_PlanRequest2& message);

// Never throws for what is on the wire: what cannot be meant (not finite, an unknown choice) becomes order.refusal. All
// else is, or is written down as, a document for parse_request(), so that a request is validated in one place however
// it came.
Order decode(const fjr_msg_MotionRequest& message);
Order decode(const fjr_msg_PlanRequest2& message);
Order decode(const fjr_msg_PlanRequest& message);

// What one service tells the others of a request that it has heard and that is theirs to answer.
struct Relayed {
  Order order;
  double silence = 0;      // [s] since its client was heard
  bool cancelled = false;  // meanwhile
};
fjr_msg_RelayedRequest encode(const Relayed& relayed);
Relayed decode(const fjr_msg_RelayedRequest& message);

}  // namespace fjr::dds
