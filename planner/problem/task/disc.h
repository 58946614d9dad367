// Both links keep clear of a disc in the plane of motion.
#pragma once

#include <algorithm>

#include "planner/problem/task/constraint.h"

namespace fjr {

// `margin` is kept over the links' whole length, beside their radius. [m]
struct Disc {
  Coordinates center{};
  double radius = 0, margin = 0;

  static constexpr ConstraintInfo info{.name = "obstacles", .keeps_clear = true, .sign = -1, .most = 0};

  void add_rows(TaskRows& to) const {
    for (int link = 1; link <= kJoints; ++link) {
      const auto kind = link == 1 ? TaskRow::Kind::kClearance1 : TaskRow::Kind::kClearance2;
      const double apart = radius + margin + to.robot.link.radius[static_cast<std::size_t>(link - 1)];
      to.add(kind, center, apart, 0, task::kNone, apart, link);
    }
  }

  template <class Place>
  void check(const Place& place) const {
    task::check_point(place.at("center"), center);
    task::check_between(place.at("radius"), radius, 0, task::kLargestCoordinate, "m");
    task::check_between(place.at("margin"), margin, 0, task::kLargestCoordinate, "m");
  }

  double relaxed_by() const { return radius + margin; }
  void relax(double size) {
    margin = std::min(margin, size);
    radius = size - margin;
  }

  template <class Drawing>
  void draw(Drawing& in) const {
    in.disc(center, radius, margin);
  }
};

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Disc>
void visit(R& r, Visit&& v) {
  v(Key{"center", "m", "of the disc", kNeeded, "within 10 of the base"}, r.center);
  v(Key{"radius", "m", "of the disc", kNeeded, "0 to 10"}, r.radius);
  v(Key{"margin", "m", "kept beside radius and link", "0", "0 to 10"}, r.margin);
}

}  // namespace fjr
