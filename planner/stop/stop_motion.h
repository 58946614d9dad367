// Controlled stops: from where a plan is to rest, without leaving the links swinging.
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

inline constexpr double kStopSpacing = 0.02;  // [s] between the instants of a plan for which a stop is at hand

// What a stop may use. It begins in the middle of a plan that may itself be at its limits, with the torque continuous
// and its slope to be found: so torque gets half of what the drive has beyond the planning limit (the other half is
// left to feedback), motor velocity 5 %, and deflection 1 %, where the springs are still as identified. Positions get
// nothing: there may be a wall.
Limits stop_limits(const Parameters& robot);

inline constexpr double kShortestStop = 0.05, kLongestStop = 1.5;  // [s]

// The arm is flat in q: any q(t) that leaves with the plan's q and four derivatives and arrives with four zero ones is
// a motion from the plan's state to rest. The shortest degree-9 polynomial per joint within the limits, its end free;
// where the plan is so fast that none is, with bumps added that vanish with four derivatives at both ends. Nothing:
// none was found. shortest, longest [s]: where to search; it never takes less than kShortestStop.
std::optional<StopMotion> find_stop(const Parameters& robot, const Sample& from, double shortest, double longest);

// Two counts of the link encoder: how far the links may be from a stop, and may swing after it. [rad]
double stop_exactness(const Parameters& robot);

// The stop on the exact model in closed loop and 0.25 s of rest after it: within its limits, links within
// stop_exactness() of it throughout. Empty, or what is wrong with it.
std::string fault_of_stop(const Parameters& robot, const Trajectory& stop);

struct NoStop : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Its rows, beginning with the plan's row `from`: every millisecond, and between where the torque needs it. Throws
// NoStop, one sentence, when the numbers are no stop, or one that is not within stop_limits() at every millisecond.
Trajectory stop_rows(const Parameters& robot, const Sample& from, const StopMotion& stop);

// One per kStopSpacing from the beginning of the plan on, rolled out. `between` is called after each. Throws NoStop,
// one sentence.
std::vector<StopMotion> stop_motions(const Parameters& robot, const Trajectory& plan,
                                     const std::function<void()>& between);

// How many that are. [-]
std::size_t count_of_stops(const Trajectory& plan);

// The i-th stop of a plan, whoever computed it: its rows, rolled out here. Empty rows: there is none, and the plan
// itself ends within kLongestStop. Throws NoStop, one sentence.
Trajectory checked_stop(const Parameters& robot, const Trajectory& plan, std::size_t i, const StopMotion& stop);

}  // namespace fjr
