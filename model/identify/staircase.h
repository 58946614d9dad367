// The common part of the stiffness and gravity procedures: a staircase log is averaged and fitted by a line with
// separate branches.
#pragma once

#include <cmath>
#include <string>
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

std::vector<Landing> landings(const Log& log, int joint, std::vector<std::string>& warnings);

// The abscissa of a fit.
using Abscissa = double (*)(const Landing&);
inline double deflection_of(const Landing& l) { return l.theta - l.q; }  // [rad]
inline double sine_of_angle(const Landing& l) { return std::sin(l.q); }

// All landings, and the intercepts of the lines that were fitted to the settled ones. Their slope is
// Estimate::value[0].
struct FittedStaircase {
  std::vector<Landing> landings;
  double rising, falling;  // [N m]  tau of either line where the abscissa is zero
};

// Fits tau = slope x + an intercept for each of the rising and falling branches. Saturated hysteresis shifts a branch
// but does not change its slope. Landings that are not settled are left out, and outliers are rejected. Fills in value
// (slope), covariance, the goodness of fit, and a FittedStaircase.
void fit_branches(const Log& log, const std::vector<Landing>& points, Abscissa x, Estimate& estimate);

// Returns only the slope, from settled landings.
double branch_slope(const Log& log, const std::vector<Landing>& points, Abscissa x);

}  // namespace fjr
