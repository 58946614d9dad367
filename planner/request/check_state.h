// Checks the states that a request names, its start, its goal and its via points, against the limits.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/request/place.h"

namespace fjr {

// A state in the request, and which of its parts were given.
struct StatePlace {
  Place place;
  bool q = false, dq = false, theta = false, dtheta = false;
};

// What is known of a state, given or not.
struct KnownState {
  Joints<double> q{};                                     // [rad]
  std::optional<Joints<double>> dq{}, theta{}, dtheta{};  // [rad/s], [rad], [rad/s]
  bool at_rest = false;                                   // then the motors hold it: their torque is known, too
};

// Throws InputError if the state exceeds a limit of the list Quantities. A quantity that depends on what is not known
// is not checked, nor are the angles q, for which check_angle() (place.h) has messages of its own.
void check_state(const StatePlace& place, const Problem& problem, const KnownState& state);

// Throws InputError if there is no angle of the goal's free joint at which the motors can hold the arm still.
void check_holding_somewhere(const Place& place, const Problem& problem, const Goal& goal);

}  // namespace fjr
