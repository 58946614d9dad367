// The closed loop from elsewhere than exactly the start.
#pragma once

#include "common/parallel.h"
#include "planner/certificate/certificate.h"

namespace fjr {

// Half a count of the link encoder: that far the arm may be off the start while the encoder reads the start. [rad]
double start_offset(const Parameters& p, std::size_t joint);

// Rolls the trajectory out from its first row in closed loop with the whole arm, links and motors, start_offset() off
// in either joint, all four combinations of signs, and a thousandth of that off in both. The largest errors are kept.
// Where the plan rests on the way, the executor holds the arm from where it came to, with its ticks and the counts of
// the encoders, as it does after an end at rest. There it holds the arm, from each of their ends.
// for_each: the five starts are independent of each other.
Perturbed roll_out_perturbed(const Parameters& p, const Trajectory& trajectory,
                             const ForEach& for_each = one_after_another);

}  // namespace fjr
