// How fast a rigid arm would be whose joints move independently of each other: what guesses take their times from.
#pragma once

#include <array>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

// [s] Roughly the duration of each segment if the arm rests at every via point.
std::vector<double> times_between_rests(const Problem& problem);

// One joint's way between two points. It accelerates by at most `most`.
struct JointTransfer {
  double distance;  // [rad]
  double from, to;  // velocities at its ends [rad/s]
  double most;      // [rad/s^2]
};

// Returns whether a transfer can take exactly this long [s]. Not every time above the shortest one is possible: a joint
// that moves already passes a point ahead at once, or it has to come round again.
bool can_take(const JointTransfer& transfer, double time);

// Returns the shortest time [s], not below `least`, that all these transfers can take. (T. Kroeger, F. M. Wahl: Online
// trajectory generation, IEEE Trans. Robotics 26, 2010, on times that are blocked between others.)
double shortest_common_time(const std::array<JointTransfer, kJoints>& transfers, double least);

// How the arm passes start, via points and goal.
struct Passing {
  std::vector<Joints<double>> velocities;  // [rad/s] there
  std::vector<double> times;               // [s] of each segment
  // [s] The sum of the times, each multiplied by the factor (1 to 16) by which accelerations may exceed the joints'
  // bounds in that segment.
  double price = 0;
};

// Returns the fastest passing, with the velocities that the problem leaves open chosen for it: by dynamic programming
// over a grid of them that becomes finer round the best (R. Luus: Iterative dynamic programming, 2000). Joints may
// accelerate more than they can, at a price: where velocities cannot be reached from each other otherwise, or only by
// going back and coming again. A throw must not.
Passing fastest_passing(const Problem& problem);

}  // namespace fjr
