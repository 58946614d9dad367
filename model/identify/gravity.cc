#include <fmt/format.h>

#include "model/identify/checks.h"
#include "model/identify/procedures.h"
#include "model/identify/staircase.h"

namespace fjr {

// At rest the motor torque equals the spring torque, which equals the gravity torque. So neither stiffness nor
// hysteresis affects the result.
Estimate identify_gravity(const Log& log, int joint, const Parameters& robot) {
  require_radians(log, joint);
  Estimate e;
  e.names = {"gravity_slope"};
  e.units = {"N m"};
  const std::vector<Landing> points = landings(log, joint, e.warnings);
  fit_branches(log, points, sine_of_angle, e);
  const Joints<double>& g = robot.link.gravity_torque;
  require_plausible(log, fmt::format("the gravity torque of joint {} [N m]", joint + 1), e.value[0],
                    joint == 0 ? g[0] + g[1] : g[1]);
  // theta does not enter the slope, so an error in it would be noticed only later, where it is used. Check it here.
  require_plausible(log, fmt::format("the stiffness of joint {} [N m/rad]", joint + 1),
                    branch_slope(log, points, deflection_of), robot.spring.stiffness[static_cast<std::size_t>(joint)]);
  return e;
}

}  // namespace fjr
