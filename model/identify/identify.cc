#include <stdexcept>

#include "model/identify/procedures.h"

namespace fjr {
namespace {

Estimate identify_named(const std::string& name, const Log& log, int joint, const Parameters& robot) {
  if (name == "stiffness") return identify_stiffness(log, joint, robot);
  if (name == "gravity") return identify_gravity(log, joint, robot);
  if (name == "link_inertia") return identify_link_inertia(log, joint, robot);
  if (name == "motor_friction") return identify_motor_friction(log, joint, robot);
  if (name == "motor_inertia") return identify_motor_inertia(log, joint, robot);
  throw std::invalid_argument("no procedure is named " + name);
}

}  // namespace

Estimate identify(const std::string& name, const Log& log, int joint, const Parameters& robot) {
  Estimate estimate = identify_named(name, log, joint, robot);
  estimate.procedure = name;
  estimate.joint = joint;
  estimate.log = log.source;
  estimate.hash = log.hash;
  return estimate;
}

}  // namespace fjr
