// Decides what the points determine about h of (24), the sharpness of its second kink.
#pragma once

#include <vector>

#include "model/identify/estimate.h"
#include "model/identify/friction_fit.h"

namespace fjr {

// A sharp kink at rest is the same for (g, h) and (-g, 2 - h), but h > 0 has a further kink at the speed h eta. If that
// is at least twice the highest measured speed, the equivalent parameters with 2 - h <= 0 are returned.
Eigen::VectorXd without_unseen_kink(const std::vector<FrictionPoint>& points, Eigen::VectorXd p);

// Returns true only if a perfectly sharp kink is clearly excluded, because by chance it looks blunt in a few of a
// hundred logs.
bool shape_is_known(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& fit);

// Used if no speed lies within the kink: h stays as in robot.yaml if the points allow it, or else becomes the bound.
// Returns the fit of the other parameters with h, and adds a warning to `e`.
Fit assume_shape(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& free,
                 double known, double& h, Estimate& e);

}  // namespace fjr
