// Controlled stops: motions from a state of a plan to rest that do not leave the links oscillating.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/flatness.h"
#include "planner/problem/problem.h"
#include "planner/stop/stop.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline constexpr double kStopSpacing = 0.02;  // [s] between the instants of a plan for which stops are computed

inline constexpr double kShortestStop = 0.05, kLongestStop = 1.5;  // [s]

// Returns the shortest stop within the limits that was found, or nothing. Because the arm is differentially flat in q,
// any q(t) that begins with the plan's q and four derivatives and ends with four zero derivatives is a motion from the
// plan's state to rest. The search uses a polynomial of degree 9 per joint with free end position, and bumps that
// vanish with four derivatives at both ends: 3 of them or, for fast plans for which these are not enough, 5. shortest,
// longest [s]: range of durations; none is below kShortestStop.
std::optional<StopMotion> find_stop(const Parameters& robot, const Sample& from, double shortest, double longest);

// Returns how far [rad] the links may deviate from a stop and oscillate after it: two counts of the link encoder.
double stop_exactness(const Parameters& robot);

// Simulates the stop, and 0.25 s of rest after it, on the exact model in closed loop. Returns what is wrong: a limit of
// stop_limits() that is exceeded, or links that deviate by more than stop_exactness(); nothing if all is well.
std::optional<std::string> fault_of_stop(const Parameters& robot, const Trajectory& stop);

// There is no usable stop; what() is one sentence with the reason.
struct NoStop : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Returns the samples of a stop, beginning with the plan's sample `from`: one every millisecond, and more where the
// torque changes fast. Throws NoStop if one of those every millisecond is not within stop_limits(), or not a number.
Trajectory stop_rows(const Parameters& robot, const Sample& from, const StopMotion& stop);

// Returns a stop, checked by a rollout, for every kStopSpacing from the beginning of the plan. Calls `between` after
// each. Throws NoStop if there is none for an instant more than kLongestStop before the end.
std::vector<StopMotion> stop_motions(const Parameters& robot, const Trajectory& plan,
                                     const std::function<void()>& between);

// Returns the number of stops that stop_motions() returns.
std::size_t count_of_stops(const Trajectory& plan);

// Checks the i-th stop of a plan from any source by a rollout and returns its samples. They are empty if the stop says
// that there is none and the plan ends within kLongestStop. Throws NoStop if the stop cannot be used.
Trajectory checked_stop(const Parameters& robot, const Trajectory& plan, std::size_t i, const StopMotion& stop);

}  // namespace fjr
