// The next repetition of a motion, as a solving process finds it.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"
#include "planner/plan.h"
#include "planner/protocol/messages.h"
#include "planner/service/repetition_frame.h"

namespace fjr {

struct Repeated {
  PlanStatus status = PlanStatus::kUncertified;  // certified: the rows may be executed
  std::string reason;
  std::string plan_json;  // the plan's, with `repetition`; empty where the rows may not be executed
  std::vector<Sample> rows;
  LinkErrors errors;  // as planned; as expected of the rows
};

// Within the limits and the task that plan_json says. Of a run that nothing can be learnt from, and where a correction
// would break what the rows as they were do not, the same rows are repeated, and `repetition` says why. Throws
// std::exception where the plan_json is none of a plan.
Repeated repeat(const Parameters& robot, const RunOfMotion& run);

}  // namespace fjr
