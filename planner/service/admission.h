// Decides which requests a service accepts, and gives the reasons for refusals.
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

// Returns whether the motion is to begin wherever the arm rests. The motion must have been read.
inline bool leaves_start_out(const Order& order) { return order.motion && !order.motion->start; }

Refusal refusal_of(const InputError& error);  // converts an error in a request document

// Checks a request of any kind without its motion: robot, budget and the like. Returns nothing if it is accepted.
std::optional<Refusal> refusal_of_terms(const Order& order, const Served& served);

// Reads the order's document into order.motion, unless that was done already. Refuses documents that are not requests.
std::optional<Refusal> read_motion(Order& order);

// Checks a motion to be planned, whose start must be known, and fills in what follows from it in the job.
std::optional<Refusal> refusal_of_motion(Job& job, const Parameters& robot);

// Checks what does not depend on where the arm rests, and reads the motion for that. If the start is left out, the
// consequences of the start are not checked.
std::optional<Refusal> refusal_at_sight(Order& order, const Served& served, const Parameters& robot);

// Checks whether the plan with this id may be executed on the served robot. planned: the reply to it, if still known.
std::optional<Refusal> refusal_of_execution(const RequestId& id, const SharedReply& planned, bool in_hand,
                                            const std::string& robot_hash);

}  // namespace fjr
