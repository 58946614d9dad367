// Combines several logs of the same experiment.
#pragma once

#include <vector>

#include "model/identify/estimate.h"

namespace fjr {

// The combined result of all logs of one experiment on one joint.
struct Repeated {
  Estimate estimate;                  // its `log` contains the names of all logs
  std::vector<const Estimate*> logs;  // the combined estimates, which must outlive this object
};

// Groups the estimates by experiment and joint, in the order of each group's first log. Several logs are combined by
// least squares with the inverses of their covariances as weights. If they differ by more than their covariances allow,
// the covariance is multiplied by chi^2 per degree of freedom (Birge, Phys. Rev. 40, 1932). Parameters that only some
// logs determine are taken from these. If all logs assume a parameter, the value of the largest magnitude is used,
// which is compatible with the bounds of all logs. Throws InputError if a log occurs twice or has no standard errors.
std::vector<Repeated> combine_repeated(const std::vector<Estimate>& estimates);

}  // namespace fjr
