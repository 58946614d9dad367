// What the points say about h of (24), the sharpness of its second kink.
#pragma once

#include <vector>

#include "model/identify/estimate.h"
#include "model/identify/friction_fit.h"

namespace fjr {

// A sharp kink at rest is the same with (g, h) and (-g, 2 - h), but h > 0 adds a kink at the speed h eta. Where that is
// beyond every speed, h < 0 is meant.
Eigen::VectorXd without_unseen_kink(const std::vector<FrictionPoint>& points, Eigen::VectorXd p);

// Only if a perfectly sharp kink is excluded by much: chance makes it look blunt in a few logs of a hundred.
bool shape_is_known(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& fit);

// When no speed falls into the kink: h stays what robot.yaml says if the points allow that, or becomes the bound.
// Gives the fit of the others and h; says so in `e`.
Fit assume_shape(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& free,
                 double known, double& h, Estimate& e);

}  // namespace fjr
