// What logs from outside get wrong, found out and said.
#pragma once

#include <string>
#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"

namespace fjr {

// Throws InputError when `found` cannot be true given what is known so far (`expected`, same unit): the wrong sign, or
// more than `factor` off, with the unit that would explain it. what: "the stiffness of joint 1 [N m/rad]".
void require_plausible(const Log& log, const std::string& what, double found, double expected, double factor = 10);

// Throws InputError when the log's metadata say another experiment or joint (0 or 1); absent metadata are believed.
void require_experiment(const Log& log, const std::string& experiment, int joint);

// Throws InputError for positions that must be degrees: often beyond two revolutions in a link's column.
void require_radians(const Log& log, int joint);

// The usual one. [s]
double sample_interval(const Log& log);

// Says how many samples are missing.
void warn_of_gaps(const Log& log, std::vector<std::string>& warnings);
void warn_of_outliers(std::size_t rejected, const std::string& what, std::vector<std::string>& warnings);
// Says which parameters the log hardly determines.
void warn_of_doubt(Estimate& estimate);

}  // namespace fjr
