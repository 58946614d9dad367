// What a service takes on, and why not.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/input_error.h"
#include "model/parameters.h"
#include "planner/protocol/messages.h"
#include "planner/service/job_queue.h"

namespace fjr {

struct Served {
  std::string robot_id;          // by this service
  std::set<std::string> robots;  // by this one and the others
  std::string robot_hash;
  double longest_budget = 0;  // [s]
};

inline bool executes(const Order& order) { return order.action != Action::kPlan; }

// The motion begins wherever the arm rests. Of a motion that was read.
inline bool leaves_start_out(const Order& order) { return order.motion && !order.motion->start; }

Refusal refusal_of(const InputError& error);  // in a request document

// Of whatever kind it is, before its motion is looked at.
std::optional<Refusal> refusal_of_terms(const Order& order, const Served& served);

// Reads the order's document into order.motion, unless that was done; what is no request is refused.
std::optional<Refusal> read_motion(Order& order);

// Of a motion to be planned, whose start is given by now. What is learnt about it is put into the job.
std::optional<Refusal> refusal_of_motion(Job& job, const Parameters& robot);

// What can be told without knowing where the arm rests; reads the motion. Of one whose start is left out that is what
// its document says, and not what follows from the start.
std::optional<Refusal> refusal_at_sight(Order& order, const Served& served, const Parameters& robot);

// Of executing what was planned under `id`, on the served robot. planned: what became of it, if that is still known.
std::optional<Refusal> refusal_of_execution(const RequestId& id, const SharedReply& planned, bool in_hand,
                                            const std::string& robot_hash);

}  // namespace fjr
