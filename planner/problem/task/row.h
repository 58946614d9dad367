// A row of a task constraint: lower <= value(q) <= upper. It depends on the links' positions alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "model/kinematics.h"
#include "model/parameters.h"

namespace fjr {

// Positions of the arm, the argument of rows.
template <class T>
struct Posture {
  Joints<T> q;
  Point<T> elbow, tip;

  static Posture of(const Parameters& robot, const Joints<T>& q) {
    return {q, elbow_position(robot, q), tip_position(robot, q)};
  }
};

struct ConstraintInfo;

struct TaskRow {
  enum class Kind {
    kTip,         // vector . tip - number                                 [m]
    kTipRadius,   // (|tip - vector|^2 - number^2) / (2 number)            [m] distance from a circle, near it
    kClearance1,  // (distance^2 - number^2) / (2 number) of link 1 from the point `vector`: to first order the
    kClearance2,  // clearance, and smooth where the distance itself is not; of link 2                            [m]
    kAngles,      // vector . q - number                                   [rad]
    kElbow,       // vector . elbow - number                               [m]
  };
  Kind kind;
  std::array<double, 2> vector;  // of coordinates, or of the joints' angles
  double number;
  double lower, upper;
  double scale;                         // size of the constraint, to which fractions refer  [m or rad]
  std::string name;                     // in plan.json: obstacles[0], walls[0], tip_box, tip_line, tip_arc, path
  int link;                             // 1 or 2 for obstacles and walls; 0: neither
  const ConstraintInfo* info;           // the kind of its constraint
  std::size_t constraint;               // number of its constraint in the task, in the order of each_constraint()
  std::optional<std::size_t> across{};  // of a row along a line: number of the row across it (task::add_band)

  template <class T>
  T value(const Parameters& robot, const Posture<T>& at) const;

  const char* unit() const { return kind == Kind::kAngles ? "rad" : "m"; }
  // Returns whether value() is a distance wherever the arm is; otherwise it is one near a circle alone.
  bool is_distance() const;

  // Returns the distance of a value from the bounds; negative if it violates them. [m or rad]
  double clearance(double value) const { return std::min(value - lower, upper - value); }
  // Returns the same as a true distance, which differs from value() well away from a circle. [m or rad]
  double distance(double value) const;
};

inline bool TaskRow::is_distance() const {
  switch (kind) {
    case Kind::kTip:
    case Kind::kElbow:
    case Kind::kAngles:
      return true;
    case Kind::kTipRadius:
    case Kind::kClearance1:
    case Kind::kClearance2:
      break;
  }
  return false;
}

// Returns by how much [m or rad] the row's value changes at most if both joints are off by `angle` [rad].
inline double moved_by(const Parameters& robot, const TaskRow& row, double angle) {
  const double near = robot.link.length[0], far = near + robot.link.length[1];
  switch (row.kind) {
    case TaskRow::Kind::kAngles:
      return angle * (std::abs(row.vector[0]) + std::abs(row.vector[1]));
    case TaskRow::Kind::kElbow:
    case TaskRow::Kind::kClearance1:
      return angle * near;
    case TaskRow::Kind::kTip:
    case TaskRow::Kind::kTipRadius:
    case TaskRow::Kind::kClearance2:
      break;
  }
  return angle * (far + robot.link.length[1]);
}

// ---- details of templates ----

inline double TaskRow::distance(double value) const {
  const auto true_one = [&](double v) {
    return !is_distance() ? std::sqrt(std::max(0.0, number * (number + 2 * v))) - number : v;
  };
  return std::min(true_one(value) - true_one(lower), true_one(upper) - true_one(value));
}

template <class T>
double value_of(const T& x) {
  if constexpr (requires { x.v; }) {
    return x.v;
  } else {
    return x;
  }
}

// Returns the squared distance [m^2] of the point p from the segment of the given length from `begin` to `end`.
template <class T>
T squared_distance(const Coordinates& p, const Point<T>& begin, const Point<T>& end, double length) {
  const T to_x = p[0] - begin.x, to_y = p[1] - begin.y;
  const T along_x = (end.x - begin.x) * (1 / length), along_y = (end.y - begin.y) * (1 / length);
  const double along = value_of(to_x) * value_of(along_x) + value_of(to_y) * value_of(along_y);
  // A sparsity pattern has no value to choose by; the formula beside the segment depends on everything.
  const bool structure_only = requires(T t) { t.depends_on(0); };
  if (!structure_only && along < 0) return to_x * to_x + to_y * to_y;
  if (!structure_only && along > length) {
    const T x = p[0] - end.x, y = p[1] - end.y;
    return x * x + y * y;
  }
  const T across = along_x * to_y - along_y * to_x;
  return across * across;
}

template <class T>
T TaskRow::value(const Parameters& robot, const Posture<T>& at) const {
  const auto from_circle = [this](const T& squared) { return (squared - number * number) * (0.5 / number); };
  switch (kind) {
    case Kind::kTip:
      return vector[0] * at.tip.x + vector[1] * at.tip.y - number;
    case Kind::kElbow:
      return vector[0] * at.elbow.x + vector[1] * at.elbow.y - number;
    case Kind::kTipRadius: {
      const T x = at.tip.x - vector[0], y = at.tip.y - vector[1];
      return from_circle(x * x + y * y);
    }
    case Kind::kClearance1:
      return from_circle(squared_distance(vector, Point<T>{T(0.0), T(0.0)}, at.elbow, robot.link.length[0]));
    case Kind::kClearance2:
      return from_circle(squared_distance(vector, at.elbow, at.tip, robot.link.length[1]));
    case Kind::kAngles:
      break;
  }
  return vector[0] * at.q[0] + vector[1] * at.q[1] - number;
}

}  // namespace fjr
