// How fast a motor turns, by the drive's own velocity or by its encoder.
#pragma once

#include <vector>

#include "model/identify/row_ranges.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// Whether the log has a dtheta<joint> that says more than theta<joint>: counts differentiated row by row do not, for
// one count in a millisecond is 1.57 rad/s.
bool has_own_velocity(const Log& log, int joint, const Parameters& robot);

// The drive's own, or else slopes of theta over `window` rows, good to two counts in that time.
Signal velocity(const Log& log, int joint, const Parameters& robot, std::size_t window);

// At constant speed: the mean of the drive's own without outliers, or else the slope of theta.
struct Speed {
  double mean, standard_error;  // [rad/s]
  std::size_t rejected;         // outliers
};
Speed constant_speed(const Log& log, int joint, const Parameters& robot, const RowRange& range);

// Throws InputError when the drive's own velocity and theta contradict each other over the ranges: in sign or unit.
void require_consistent_velocity(const Log& log, int joint, const Parameters& robot,
                                 const std::vector<RowRange>& ranges);

}  // namespace fjr
