// Both links keep to one side of a straight line: a wall, a table, a fence.
#pragma once

#include <algorithm>
#include <cmath>

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<Wall>{.name = "walls", .keeps_clear = true, .relaxed = "moved back by {} m"};
template <>
inline constexpr Key kRequestKey<Wall>{kInfo<Wall>.name, "", "straight lines that both links keep to one side of",
                                       "none", "the base is on that side; at most 64, obstacles included"};

// Returns the direction from the wall to where the arm may be, of length 1.
inline Coordinates away_from(const Wall& wall) {
  const double size = task::length(wall.normal);
  return {wall.normal[0] / size, wall.normal[1] / size};
}

// A link is furthest beyond a straight line at one of its ends; the base does not move. So the elbow is kept clear by
// the thicker of the links, and the tip by the second.
inline void add_rows(const Wall& wall, TaskRows& to) {
  const Coordinates away = away_from(wall);
  const Joints<double>& radius = to.robot.link.radius;
  const double through = task::dot(away, wall.point);
  for (int link = 1; link <= kJoints; ++link) {
    const double apart = wall.margin + (link == 1 ? std::max(radius[0], radius[1]) : radius[1]);
    to.add(link == 1 ? TaskRow::Kind::kElbow : TaskRow::Kind::kTip, away, through, apart, task::kNone, task::kArmScale,
           link);
  }
}

template <class Place>
void check(const Wall& wall, const Place& place) {
  task::check_point(place.at("point"), wall.point);
  task::check_between(place.at("margin"), wall.margin, 0, task::kLargestCoordinate, "m");
  if (!std::isnormal(task::length(wall.normal))) {
    place.at("normal").fail("has no direction; it points to where the arm may be");
  }
  const double base = -task::dot(away_from(wall), wall.point);
  if (base < wall.margin) {
    place.fail(
        fmt::format("the base of the arm, [0, 0] m, is {:.4g} m beyond it, its margin included", wall.margin - base));
  }
}

// How far the wall is moved back. [m]
inline double relaxed_by(const Wall&) { return 0; }
inline void relax(Wall& wall, double back) {
  const Coordinates away = away_from(wall);
  wall.point = {wall.point[0] - back * away[0], wall.point[1] - back * away[1]};
}

template <class Drawing>
void draw(const Wall& wall, Drawing& in) {
  in.half_plane(wall.point, away_from(wall));
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Wall>
void visit(R& r, Visit&& v) {
  v(Key{"point", "m", "that the wall goes through", kNeeded, "within 10 of the base"}, r.point);
  v(Key{"normal", "1", "points from the wall to where the arm may be; of any length", kNeeded}, r.normal);
  v(Key{"margin", "m", "kept beside the links' radius", "0", "0 to 10"}, r.margin);
}

}  // namespace fjr
