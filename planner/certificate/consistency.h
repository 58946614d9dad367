// Checks whether the rows are a possible trajectory at all, before any physics.
#pragma once

#include <optional>
#include <string>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Returns why the rows cannot be rolled out: too few or too many, not finite, time not increasing by 1 ns at least, or
// longer than the longest rollout, 164 s. Returns nothing if they can.
std::optional<std::string> malformed(const Trajectory& trajectory);

// Returns a sentence if a velocity column does not belong to its position column, else nothing. In every
// interval the mean of the two end velocities may differ from the mean velocity (x1 - x0)/h by h |a1 - a0| / 8, the
// most that a corner of the velocity can cause (a: accelerations of the model at the rows), plus a tolerance:
// - links: one encoder count within 10 ms,
// - motors: the velocity error that makes a tenth of the feedback torque which a certificate allows.
// The means say nothing of velocities that alternate from row to row. Therefore a motor's velocity must also change as
// its accelerations make it: by no more than kUnexplainedVelocity otherwise, and unexplained_acceleration() in time.
std::optional<std::string> inconsistent_velocity(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
