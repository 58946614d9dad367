// The next repetition of a motion, as a solving process finds it.
#pragma once

#include <string>
#include <vector>

#include "model/parameters.h"
#include "planner/plan.h"
#include "planner/protocol/messages.h"
#include "planner/service/repetition_frame.h"

namespace fjr {

struct FoundRepetition {
  PlanStatus status = PlanStatus::kUncertified;  // certified: the rows may be executed
  std::string reason;
  std::string plan_json;  // the plan's, with `repetition`; empty where the rows may not be executed
  std::vector<Sample> rows;
  LinkErrors errors;  // of the rows: `certified` is the plan's, `predicted` what is expected of them
};

// Within the limits and the task that plan_json says. Of a run that nothing can be learnt from, and where a correction
// would break what the rows as they were do not, the same rows are repeated, and `repetition` says why. Throws
// std::exception where plan_json and rows are not those of a plan, or where no reply has room for what comes of it.
FoundRepetition find_repetition(const Parameters& robot, const RunOfMotion& run);

}  // namespace fjr
