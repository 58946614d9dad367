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
  const Abscissa deflection{[](const Landing& l) { return l.theta - l.q; }, "theta - q [rad]"};
  const std::string title = fmt::format("Fig. {}: stiffness of joint {}", 3 + joint, joint + 1);
  const std::vector<Landing> points = landings(log, joint, e.warnings);
  fit_branches(log, points, deflection, title, e);
  Chart loop = branch_chart(title + ", hysteresis", points, deflection, e.value[0]);
  loop.y_label = "tau - K (theta - q) [N m]";
  e.charts.insert(e.charts.begin() + 1, std::move(loop));
  require_plausible(log, fmt::format("the stiffness of joint {} [N m/rad]", joint + 1), e.value[0],
                    robot.spring.stiffness[static_cast<std::size_t>(joint)]);
  return e;
}

}  // namespace fjr
