// Converts the results of the procedures to the parameters of the model, by (6)-(8) and (15)-(18).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/dynamics.h"
#include "model/identify/estimate.h"
#include "model/parameters.h"

namespace fjr {

struct Identified {
  Parameters robot;                // `base` with all identified parameters
  std::vector<std::string> names;  // "spring.stiffness[0]", ...: what they tell, in the order of the covariance
  Eigen::MatrixXd covariance;
  std::map<std::string, std::vector<const Estimate*>> from;  // by name; the estimates must outlive this object
  Joints<double> damping;                                    // [N m s/rad]  D of (9); not in `robot`
  Joints<double> damping_error;                              // standard errors
  Joints<bool> has_damping{false, false};
};

// Combines the estimates. Several logs of one experiment count as one (repeated.h). Parameters without an estimate stay
// as in `base` and count as exactly known; lengths and masses always do, since they are measured directly. Covariances
// are propagated to first order with exact derivatives.
Identified combine(const Parameters& base, const std::vector<Estimate>& estimates);

}  // namespace fjr
