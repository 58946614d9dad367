// From what the procedures give to the parameters of the model: the split of (6) into (8), and (15)-(18).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/dynamics.h"
#include "model/identify/estimate.h"
#include "model/parameters.h"

namespace fjr {

struct Identified {
  Parameters robot;                // `base` with everything the estimates tell
  std::vector<std::string> names;  // "spring.stiffness[0]", ...: what they tell, in the order of the covariance
  Eigen::MatrixXd covariance;
  std::map<std::string, std::vector<const Estimate*>> from;  // by name; estimates outlive this
  Joints<double> damping;                                    // [N m s/rad]  D of (9); not in `robot`
  Joints<double> damping_error;                              // standard errors
  Joints<bool> has_damping{false, false};
};

// Several logs of one experiment count as one (repeated.h). What no estimate tells stays as in `base`, known exactly.
// Lengths and masses always do: they are weighed and measured. Covariances are propagated linearly, with exact
// derivatives.
Identified combine(const Parameters& base, const std::vector<Estimate>& estimates);

}  // namespace fjr
