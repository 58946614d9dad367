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
std::vector<Landing> landings(const Log& log, int joint, std::vector<std::string>& warnings);

// tau = slope x + rising or falling intercept: hysteresis that has saturated shifts a branch, and leaves the slope
// alone. Landings that are not settled are left out, and outliers rejected. Fills value (slope), covariance, fit and
// plot.
void fit_branches(const Log& log, const std::vector<Landing>& points, double (*x_of)(const Landing&),
                  Estimate& estimate);

}  // namespace fjr
