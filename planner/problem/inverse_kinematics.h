// The link angles that put the tip somewhere.
#pragma once

#include <optional>
#include <vector>

#include "model/kinematics.h"
#include "model/parameters.h"
#include "planner/problem/quantities.h"

namespace fjr {

// Returns all q [rad] within the limits that put the tip at `tip` [m]: up to two elbows, and full turns of joint 1 if
// the limits leave room for them. The nearest to `near` (by the largest angle) comes first. Empty if there is none.
std::vector<Joints<double>> inverse_kinematics(const Parameters& robot, const Coordinates& tip, Elbow elbow,
                                               const Limits& limits, const Joints<double>& near);

// Returns the least and the largest distance [m] of the tip from the base that the links' lengths allow.
std::array<double, 2> reach(const Parameters& robot);

// Returns the link velocities [rad/s] that move the tip at `velocity` [m/s]. Returns nothing if the arm is stretched or
// folded to within 0.01 rad, where the tip cannot move in every direction.
std::optional<Joints<double>> inverse_velocity(const Parameters& robot, const Joints<double>& q,
                                               const Coordinates& velocity);

}  // namespace fjr
