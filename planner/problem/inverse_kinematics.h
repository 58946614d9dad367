// The link angles that put the tip somewhere.
#pragma once

#include <optional>
#include <vector>

#include "model/kinematics.h"
#include "model/parameters.h"
#include "planner/problem/quantities.h"

namespace fjr {

// All q [rad] within the limits that put the tip at `tip` [m]: up to two elbows, and full turns of joint 1 where
// the limits leave room for them. Nearest to `near` (largest angle) first. Empty when there is none.
std::vector<Joints<double>> inverse_kinematics(const Parameters& robot, const Coordinates& tip, Elbow elbow,
                                               const Limits& limits, const Joints<double>& near);

// The distances of the tip from the base [m] that the links' lengths allow: nearest and furthest.
std::array<double, 2> reach(const Parameters& robot);

// Link velocities [rad/s] that move the tip at `velocity` [m/s]; none where the arm is stretched or folded, within
// 0.01 rad, and the tip cannot move in every direction.
std::optional<Joints<double>> inverse_velocity(const Parameters& robot, const Joints<double>& q,
                                               const Coordinates& velocity);

}  // namespace fjr
