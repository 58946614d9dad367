// Detects and reports typical errors in logs from outside.
#pragma once

#include <string>
#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"

namespace fjr {

// Throws InputError if `found` is implausible compared to the value known so far (`expected`, same unit): it has the
// wrong sign, or differs by more than `factor`. The message names a unit that would explain it. what: "the stiffness of
// joint 1 [N m/rad]".
void require_plausible(const Log& log, const std::string& what, double found, double expected, double factor = 10);

// Throws InputError if the log's metadata name another experiment or joint (0 or 1). Missing metadata are accepted.
void require_experiment(const Log& log, const std::string& experiment, int joint);

// Throws InputError if positions must be in degrees, because a link's column often exceeds two revolutions.
void require_radians(const Log& log, int joint);

// Returns the median sample interval [s].
double sample_interval(const Log& log);

// Adds a warning with the number of missing samples, if there are any.
void warn_of_gaps(const Log& log, std::vector<std::string>& warnings);
void warn_of_outliers(std::size_t rejected, const std::string& what, std::vector<std::string>& warnings);
// Adds a warning naming the parameters that the log hardly determines, if there are any.
void warn_of_doubt(Estimate& estimate);

}  // namespace fjr
