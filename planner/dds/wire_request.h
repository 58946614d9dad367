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

// Returns the field of a message of an earlier type for the weight of a term; null if the type does not have the term.
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

// Encodes a request for services of this version. Throws InputError if the document is not a YAML map or is too long.
fjr_msg_MotionRequest encode(const Order& order);

// Encodes a request for services of earlier versions. Throws InputError if the document does not have the form of a
// request; the service checks its content.
WireRequest encode_plan_request(const Order& order);
// Returns whether message.request contains everything, so that services that know only PlanRequest can plan it.
bool fits_plan_request(const fjr_msg_PlanRequest2& message);

// Decodes a request. Never throws because of the content of a message: impossible values (not finite, an unknown
// choice) become order.refusal. Everything else is checked by resolve(), as for all requests. A document is not parsed
// here, because that takes up to 40 ms.
Order decode(const fjr_msg_MotionRequest& message);
Order decode(const fjr_msg_PlanRequest2& message);
Order decode(const fjr_msg_PlanRequest& message);

// A request that a service has received but another instance must answer, as it is relayed to the others.
struct Relayed {
  Order order;
  double silence = 0;      // [s] since its client was heard
  bool cancelled = false;  // whether it has been cancelled meanwhile
};
fjr_msg_RelayedRequest encode(const Relayed& relayed);
Relayed decode(const fjr_msg_RelayedRequest& message);

}  // namespace fjr::dds
