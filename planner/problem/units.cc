#include "planner/problem/units.h"

namespace fjr {

std::string_view unit_of_limit(std::string_view name) {
  if (name == "torque") return "N m";
  if (name == "motor_velocity") return "rad/s";
  if (name == "torque_rate") return "N m/s";
  if (name == "tip_speed") return "m/s";
  return "rad";
}

std::string_view unit_of_term(std::string_view name) {
  if (name == "time") return "s";
  if (name == "effort") return "N^2 m^2 s";
  if (name == "torque_rate") return "N^2 m^2/s";
  if (name == "link_acceleration") return "rad^2/s^3";
  return "";
}

}  // namespace fjr
