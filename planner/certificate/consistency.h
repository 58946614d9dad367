// Whether the rows of a trajectory can be a trajectory at all, before any physics.
#pragma once

#include <string>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Why the rows cannot be rolled out: too few or too many, not finite, time not increasing, or
// longer than is rolled out, 164 s. Empty when they can.
std::string malformed(const Trajectory& trajectory);

// One sentence when a velocity column does not belong to its position column, else empty. In every interval the mean of
// the two end velocities may differ from the mean velocity (x1 - x0)/h by h |a1 - a0| / 8, the most that a corner of
// the velocity can cause (a: accelerations of the model at the rows), and beyond that by what does not matter:
// - links: one encoder count within 10 ms,
// - motors: the velocity error that makes a tenth of the feedback torque which a certificate allows.
std::string inconsistent_velocity(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
