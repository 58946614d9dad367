#include <fmt/format.h>

#include "model/identify/checks.h"
#include "model/identify/procedures.h"
#include "model/identify/staircase.h"

namespace fjr {

Estimate identify_stiffness(const Log& log, int joint, const Parameters& robot) {
  require_radians(log, joint);
  Estimate e;
  e.names = {"stiffness"};
  e.units = {"N m/rad"};
  fit_branches(log, landings(log, joint, e.warnings), deflection_of, e);
  require_plausible(log, fmt::format("the stiffness of joint {} [N m/rad]", joint + 1), e.value[0],
                    robot.spring.stiffness[static_cast<std::size_t>(joint)]);
  return e;
}

}  // namespace fjr
