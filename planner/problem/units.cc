#include "planner/problem/units.h"

namespace fjr {

std::string_view unit_of_limit(std::string_view name) {
  if (name == "torque") return "N m";
  if (name == "motor_velocity") return "rad/s";
  if (name == "torque_rate") return "N m/s";
  if (name == "tip_speed") return "m/s";
  return "rad";
}

}  // namespace fjr
