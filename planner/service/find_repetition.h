// Computes the next repetition of a motion in a solving process.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"
#include "planner/plan.h"
#include "planner/protocol/messages.h"
#include "planner/service/repetition_frame.h"

namespace fjr {

struct FoundRepetition {
  PlanStatus status = PlanStatus::kUncertified;  // the rows may be executed if it is certified
  std::string reason;
  std::string plan_json;  // the plan's, with `repetition`; empty where the rows may not be executed
  std::vector<Sample> rows;
  LinkErrors errors;  // of the rows: `certified` is the plan's, `predicted` what is expected of them
};

// Computes the next repetition within the limits and the task in plan_json. If nothing can be learnt from the run, or
// if a correction would violate what the old rows keep, the same rows are repeated and `repetition` gives the reason.
// Throws std::exception if plan_json and rows do not belong to a plan, or if the result does not fit into a reply.
FoundRepetition find_repetition(const Parameters& robot, const RunOfMotion& run);

}  // namespace fjr
