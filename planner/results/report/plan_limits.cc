#include "planner/results/report/plan_limits.h"

#include <algorithm>
#include <cmath>

namespace fjr {

std::vector<ReachedLimit> read_limits(const JsonField& plan) {
  std::vector<ReachedLimit> limits;
  const JsonField certificate = plan.at("certificate");
  if (certificate.is_null()) return limits;
  for (const JsonField& item : certificate.at("limits").items()) {
    const JsonField joint = item.at("joint");
    limits.push_back({item.at("name").text(), joint.is_null() ? 0 : static_cast<int>(joint.number()),
                      item.at("limit").number(), item.at("reached").number(), item.at("time").number(),
                      item.at("rollout").number(), item.at("passed").flag()});
  }
  return limits;
}

const ReachedLimit* find_limit(const std::vector<ReachedLimit>& limits, const std::string& name, int joint) {
  const auto found = std::find_if(limits.begin(), limits.end(),
                                  [&](const ReachedLimit& l) { return l.name == name && l.joint == joint; });
  return found == limits.end() || !std::isfinite(found->limit) ? nullptr : &*found;
}

}  // namespace fjr
