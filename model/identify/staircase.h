// The common part of the stiffness and gravity procedures: a staircase log is averaged and fitted by a line with
// separate branches.
#pragma once

#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"

namespace fjr {

// One period of the staircase: averages over its last seconds (schedule.h).
struct Landing {
  double theta, q, tau;  // [rad], [rad], [N m]
  bool rising;           // reached by increasing theta
  bool settled;          // so far from the last reversal that the hysteresis is saturated
};

// The abscissa of the fit and of the charts.
struct Abscissa {
  double (*of)(const Landing&);
  std::string label;
};
std::vector<Landing> landings(const Log& log, int joint, std::vector<std::string>& warnings);

// Fits tau = slope x + an intercept for each of the rising and falling branches. Saturated hysteresis shifts a branch
// but does not change its slope. Landings that are not settled are left out, and outliers are rejected. Fills in value
// (slope), covariance, fit, and charts of the branches with the fit and of the residuals.
void fit_branches(const Log& log, const std::vector<Landing>& points, const Abscissa& x, const std::string& title,
                  Estimate& estimate);

// Returns only the slope, from settled landings.
double branch_slope(const Log& log, const std::vector<Landing>& points, const Abscissa& x);

// Draws the landings in the paper's four branches and colours, minus a line through 0 with the given slope. With the
// fitted slope the chart shows the opening of the hysteresis.
Chart branch_chart(const std::string& title, const std::vector<Landing>& points, const Abscissa& x, double slope = 0);

}  // namespace fjr
