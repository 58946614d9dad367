// The limits of a plan and the values it reaches, from its plan.json.
#pragma once

#include <string>
#include <vector>

#include "planner/results/json_field.h"

namespace fjr {

struct ReachedLimit {
  std::string name;
  int joint;                             // 1 or 2; 0: neither
  double limit, reached, time, rollout;  // as in LimitCheck
  bool passed;
};

std::vector<ReachedLimit> read_limits(const JsonField& plan);  // empty if there is no certificate

// Returns null if there is no such limit or it is infinite.
const ReachedLimit* find_limit(const std::vector<ReachedLimit>& limits, const std::string& name, int joint);

}  // namespace fjr
