#include "planner/problem/problem.h"

namespace fjr {

double* limit_of(Limits& limits, std::string_view name, int joint) {
  if (name == "tip_speed") return &limits.tip_speed;
  double* found = nullptr;
  visit_pair_limits(limits, [&](std::string_view candidate, std::string_view, Pair<double>& limit) {
    if (candidate == name) found = &limit[static_cast<std::size_t>(joint - 1)];
  });
  return found;
}

Limits Limits::of(const Parameters& p) {
  Limits limits;
  limits.torque = p.limits.torque;
  limits.motor_velocity = p.limits.motor_velocity;
  limits.link_position = p.limits.link_position;
  limits.spring_deflection = p.limits.spring_deflection;
  return limits;
}

}  // namespace fjr
