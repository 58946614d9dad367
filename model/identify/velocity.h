// Determines the velocity of a motor, from the drive's own measurement or from its encoder.
#pragma once

#include <vector>

#include "model/identify/row_ranges.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// Returns whether the log has a dtheta<joint> with more information than theta<joint>. Encoder counts differentiated
// row by row do not, because one count in a millisecond is 1.57 rad/s.
bool has_own_velocity(const Log& log, int joint, const Parameters& robot);

// Returns the drive's own velocity, or else slopes of theta over `window` rows with a resolution of two counts in that
// time.
Signal velocity(const Log& log, int joint, const Parameters& robot, std::size_t window);

// A speed in a range of constant speed: the mean of the drive's own velocity without outliers, or else the slope of
// theta.
struct Speed {
  double mean, standard_error;  // [rad/s]
  std::size_t rejected;         // outliers
};
Speed constant_speed(const Log& log, int joint, const Parameters& robot, const RowRange& range);

// Throws InputError if the drive's own velocity and theta contradict each other over the ranges in sign or unit.
void require_consistent_velocity(const Log& log, int joint, const Parameters& robot,
                                 const std::vector<RowRange>& ranges);

}  // namespace fjr
