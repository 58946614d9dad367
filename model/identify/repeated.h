// One experiment, performed several times.
#pragma once

#include <vector>

#include "model/identify/estimate.h"

namespace fjr {

// What all logs of one experiment on one joint say together.
struct Repeated {
  Estimate estimate;                  // its log: the names of all
  std::vector<const Estimate*> logs;  // what is combined; outlive this
};

// The estimates by experiment and joint, in the order of each one's first log. Several logs are combined by weighted
// least squares, each with the inverse of its covariance as weight; where they differ by more than their covariances
// allow, chi^2 per degree of freedom enlarges the covariance (Birge, Phys. Rev. 40, 1932). What only some logs
// determine is taken from these; of what is assumed in all, the largest magnitude, which every log's bound allows.
// Throws InputError for a log that is there twice, or tells no standard error.
std::vector<Repeated> combine_repeated(const std::vector<Estimate>& estimates);

}  // namespace fjr
