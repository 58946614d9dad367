// What of a request can be relaxed, one number at a time: limits, obstacles, regions, paths, velocities on the way.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct ConstraintInfo;

// What kind of thing can be relaxed. A search for the least change also names the last two (search/explain/explain.h).
enum class RelaxableKind {
  kLimit,
  kConstraint,  // of the task
  kVelocity,    // at a via point or the goal
  kBothJoints,  // of one limited quantity, at once
  kAllLimits,   // at once
  kDuration,
  kViaTime,
};

// Relaxing by `amount` >= 0 never excludes a motion that was allowed before, but for velocities.
struct Relaxable {
  RelaxableKind kind;
  std::string name;  // torque, ..., tip_speed; obstacles[0], tip_box, tip_line, tip_arc, path; via[0].dq, goal.dq, ...
  int joint = 0;     // 1 or 2; 0: neither
  std::string unit;
  double from = 0;     // as it was asked for. Of an obstacle: radius and margin; of a box: 0, what it grows by on every
                       // side; of a velocity: 1, what it is multiplied by
  double sign = 1;     // relaxed is from + sign amount
  double most = 0;     // largest amount that means anything
  double allowed = 0;  // largest amount that a request may ask for: limits may only be tighter than the robot's
  std::function<void(Problem&, double value)> set;
  const QuantityInfo* quantity = nullptr;      // of a limit
  const ConstraintInfo* constraint = nullptr;  // of the task
  // Of a constraint: its number among the task's (each_constraint()). Of a velocity: the via point, with their number
  // the goal.
  std::size_t number = 0;
  // What it relaxes, of the limits by their index and then the task's rows; none of a velocity, or of all limits.
  std::vector<std::size_t> indices{};

  double value(double amount) const { return from + sign * amount; }
  Problem relaxed(Problem problem, double amount) const {
    set(problem, value(amount));
    return problem;
  }
};

std::vector<Relaxable> relaxables(const Problem& problem);

// A quantity that is limited for each joint, of both multiplied by the same factor.
Relaxable both_joints(const Problem& problem, const QuantityInfo& quantity);

// What the arm can do, all of it multiplied: torque, its rate, motor and tip speeds, deflections; called all_limits.
Relaxable all_limits(const Problem& problem);

// All of them but velocities relaxed by this fraction of their size.
Problem relaxed(const Problem& problem, double fraction);

}  // namespace fjr
