// The limits of a plan and what it reaches of them, as its plan.json tells.
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

std::vector<ReachedLimit> read_limits(const JsonField& plan);  // empty: there is no certificate

// Null: there is none, or it is infinite.
const ReachedLimit* find_limit(const std::vector<ReachedLimit>& limits, const std::string& name, int joint);

}  // namespace fjr
