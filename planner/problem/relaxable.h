// The numbers of a request that can be relaxed one by one: limits, obstacles, regions, paths, and requested velocities.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "planner/problem/problem.h"

namespace fjr {

struct ConstraintInfo;

inline constexpr double kLeastSize = 0.1;  // [m, rad, N m, ...] for values that are given as zero or nearly

// Kinds of numbers that can be relaxed. The search for the least change also uses the last two
// (search/explain/explain.h).
enum class RelaxableKind {
  kLimit,
  kConstraint,  // of the task
  kVelocity,    // at a via point or the goal
  kBothJoints,  // of one limited quantity, at once
  kAllLimits,   // at once
  kDuration,
  kViaTime,
};

// One number that can be relaxed. Relaxing it by `amount` >= 0 keeps every motion that was allowed before, except for
// velocities.
struct Relaxable {
  RelaxableKind kind;
  // A name of Quantities or of each_constraint() (task/task.h); via[0].dq, goal.dq, goal.tip_velocity, ...; all_limits.
  std::string name;
  int joint = 0;  // 1 or 2; 0: neither
  std::string unit;
  double from = 0;     // requested value. For an obstacle radius plus margin; for a box 0, growing on every side; for a
                       // velocity 1, a factor
  double sign = 1;     // the relaxed value is from + sign amount
  double most = 0;     // largest amount that makes sense
  double allowed = 0;  // largest amount that a request may ask for: limits may only be tighter than the robot's
  std::function<void(Problem&, double value)> set;
  const QuantityInfo* quantity = nullptr;      // of a limit
  const ConstraintInfo* constraint = nullptr;  // of the task
  // For a constraint: its number in the task (each_constraint()). For a velocity: the via point; via.size(): the goal.
  std::size_t number = 0;
  // The limits, by index, and then rows of the task that it relaxes; empty for a velocity and for all limits.
  std::vector<std::size_t> indices{};

  double size() const { return std::max(from, kLeastSize); }  // in its unit; fractions of a change refer to it
  double value(double amount) const { return from + sign * amount; }
  Problem relaxed(Problem problem, double amount) const {
    set(problem, value(amount));
    return problem;
  }
};

// Returns all that can be relaxed by itself: finite limits in the order of kLimitNames, then the constraints of the
// task in the order of each_constraint(), then the velocities asked for at via points and at the goal.
std::vector<Relaxable> relaxables(const Problem& problem);

// Returns the relaxation of a quantity of both joints by the same factor.
Relaxable both_joints(const Problem& problem, const QuantityInfo& quantity);

// Returns the relaxation of all that the arm can do by the same factor: torque, its rate, motor and tip speeds,
// deflections. It is called all_limits.
Relaxable all_limits(const Problem& problem);

// Returns the problem with everything but velocities relaxed by this fraction of its size.
Problem relaxed(const Problem& problem, double fraction);

}  // namespace fjr
