// The arm in its plane of motion: x to the right, y up, joint 1 at the origin, q = 0 hanging straight down. [m]
#pragma once

#include <array>
#include <cmath>

#include "model/parameters.h"

namespace fjr {

template <class T>
struct Point {
  T x, y;
};

// x, y of a point or of a vector in the plane, as users write them. [m]
using Coordinates = std::array<double, 2>;

// The side of the line from base to tip, looking towards the tip, on which the elbow lies.
enum class Elbow { kAny, kLeft, kRight };

// Returns the position [m] of joint 2 in the base frame: x to the right, y upwards, q = 0 hanging straight down. q:
// [rad].
template <class T>
Point<T> elbow_position(const Parameters& p, const Joints<T>& q) {
  using std::cos;
  using std::sin;
  return {p.link.length[0] * sin(q[0]), -p.link.length[0] * cos(q[0])};
}

// Returns the position [m] of the end of link 2 in the same frame; q[1] is relative to link 1.
template <class T>
Point<T> tip_position(const Parameters& p, const Joints<T>& q) {
  using std::cos;
  using std::sin;
  const Point<T> elbow = elbow_position(p, q);
  const T angle = q[0] + q[1];
  return {elbow.x + p.link.length[1] * sin(angle), elbow.y - p.link.length[1] * cos(angle)};
}

// Returns the tip velocity [m/s].
template <class T>
Point<T> tip_velocity(const Parameters& p, const Joints<T>& q, const Joints<T>& dq) {
  using std::cos;
  using std::sin;
  const T angle = q[0] + q[1], rate = dq[0] + dq[1];
  return {p.link.length[0] * cos(q[0]) * dq[0] + p.link.length[1] * cos(angle) * rate,
          p.link.length[0] * sin(q[0]) * dq[0] + p.link.length[1] * sin(angle) * rate};
}

// Returns the squared tip speed [m^2/s^2]. Of the positions it depends only on q2, and unlike the speed it is smooth at
// rest.
template <class T>
T tip_speed_squared(const Parameters& p, const T& q2, const Joints<T>& dq) {
  using std::cos;
  const double l1 = p.link.length[0], l2 = p.link.length[1];
  const T rate = dq[0] + dq[1];
  return l1 * l1 * dq[0] * dq[0] + l2 * l2 * rate * rate + 2.0 * l1 * l2 * cos(q2) * dq[0] * rate;
}

}  // namespace fjr
