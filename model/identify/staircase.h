// What stiffness and gravity share: a staircase log, averaged and fitted by a line with its branches apart.
#pragma once

#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"

namespace fjr {

// One period of the staircase: averages over its last seconds (schedule.h).
struct Landing {
  double theta, q, tau;  // [rad], [rad], [N m]
  bool rising;           // reached by increasing theta
  bool settled;          // far enough from the last reversal for the spring to have forgotten it
};

// What the landings are fitted over, for the charts too.
struct Abscissa {
  double (*of)(const Landing&);
  std::string label;
};
std::vector<Landing> landings(const Log& log, int joint, std::vector<std::string>& warnings);

// tau = slope x + rising or falling intercept: hysteresis that has saturated shifts a branch, and leaves the slope
// alone. Landings that are not settled are left out, and outliers rejected. Fills value (slope), covariance, fit and
// charts: the branches with the fit, and the residuals.
void fit_branches(const Log& log, const std::vector<Landing>& points, const Abscissa& x, const std::string& title,
                  Estimate& estimate);

// The slope alone, of settled landings.
double branch_slope(const Log& log, const std::vector<Landing>& points, const Abscissa& x);

// The landings in the paper's four branches and colours, less a line through 0: of slope 0 as they are, of the fitted
// one the opening of the hysteresis.
Chart branch_chart(const std::string& title, const std::vector<Landing>& points, const Abscissa& x, double slope = 0);

}  // namespace fjr
