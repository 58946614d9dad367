// Both links keep to one side of a straight line: a wall, a table, a fence.
#pragma once

#include <algorithm>

#include "planner/problem/task/constraint.h"

namespace fjr {

// The line goes through `point`; `normal`, of any length, points to where the arm may be. `margin` is kept beside the
// links' radius. [m]
struct Wall {
  Coordinates point{}, normal{};
  double margin = 0;

  static constexpr ConstraintInfo info{.name = "walls", .keeps_clear = true, .relaxed = "moved back by {} m"};

  // A link is furthest beyond a straight line at one of its ends; the base does not move. So the elbow is kept clear by
  // the thicker of the links, and the tip by the second.
  void add_rows(TaskRows& to) const {
    const double size = task::length(normal);
    const Coordinates away{normal[0] / size, normal[1] / size};
    const Joints<double>& radius = to.robot.link.radius;
    const double through = task::dot(away, point);
    for (int link = 1; link <= kJoints; ++link) {
      const double apart = margin + (link == 1 ? std::max(radius[0], radius[1]) : radius[1]);
      to.add(link == 1 ? TaskRow::Kind::kElbow : TaskRow::Kind::kTip, away, through, apart, task::kNone, kScale, link);
    }
  }

  template <class Place>
  void check(const Place& place) const {
    task::check_point(place.at("point"), point);
    task::check_point(place.at("normal"), normal);
    task::check_between(place.at("margin"), margin, 0, task::kLargestCoordinate, "m");
    const double size = task::length(normal);
    if (size < task::kShortest) place.at("normal").fail("has no direction; it points to where the arm may be");
    const double base = -task::dot(normal, point) / size;
    if (base < margin) {
      place.fail(
          fmt::format("the base of the arm, [0, 0] m, is {:.4g} m beyond it, its margin included", margin - base));
    }
  }

  // How far the wall is moved back. [m]
  double relaxed_by() const { return 0; }
  void relax(double back) {
    const double size = task::length(normal);
    point = {point[0] - back * normal[0] / size, point[1] - back * normal[1] / size};
  }

  template <class Drawing>
  void draw(Drawing& in) const {
    in.half_plane(point, normal);
  }

 private:
  static constexpr double kScale = 0.1;  // [m] a wall has no size of its own: the arm's
};

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Wall>
void visit(R& r, Visit&& v) {
  v(Key{"point", "m", "that the wall goes through", kNeeded, "within 10 of the base"}, r.point);
  v(Key{"normal", "1", "points from the wall to where the arm may be; of any length", kNeeded}, r.normal);
  v(Key{"margin", "m", "kept beside the links' radius", "0", "0 to 10"}, r.margin);
}

}  // namespace fjr
