// Requests on the wire.
#pragma once

#include <fjr_plan_request.h>

#include <string>
#include <string_view>
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

// Where a message of an earlier type, const or not, has a term's weight; null for terms that came after it.
template <class Message>
auto weight_in(Message& message, std::string_view term) {
  auto& objective = message.request.objective;
  if (term == "time") return &objective.time;
  if (term == "effort") return &objective.effort;
  if (term == "torque_rate") return &objective.torque_rate;
  if (term == "link_acceleration") return &objective.link_acceleration;
  if (term == "link_jerk") return &objective.link_jerk;
  if (term == "energy") return &objective.energy;
  if (term == "copper") return &message.copper;
  if (term == "peak_torque") return &message.peak_torque;
  if (term == "tip_speed") return &message.tip_speed;
  return decltype(&objective.time){};
}

// For services of this version. Throws InputError for a document that is no YAML map or too long.
fjr_msg_MotionRequest encode(const Order& order);

// For earlier ones. Throws InputError for a document that has not the shape of a request; what it asks for is the
// service's to judge.
WireRequest encode_plan_request(const Order& order);
// Whether message.request says it all, so that services that know PlanRequest only can plan it.
bool fits_plan_request(const fjr_msg_PlanRequest2& message);

// Never throws for what is on the wire: what cannot be meant (not finite, an unknown choice) becomes order.refusal. All
// else is for resolve() to judge, however the request came. A document is not read yet: that takes up to 40 ms.
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
