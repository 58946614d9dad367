// Both links keep clear of a disc in the plane of motion.
#pragma once

#include <algorithm>

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<Disc>{
    .name = "obstacles", .keeps_clear = true, .can_be_jumped_over = true, .sign = -1, .most = 0};
template <>
inline constexpr Key kRequestKey<Disc>{kInfo<Disc>.name, "",
                                       "discs in the plane of motion that both links keep clear of", "none",
                                       "at most 64, walls included"};

inline void add_rows(const Disc& disc, TaskRows& to) {
  for (int link = 1; link <= kJoints; ++link) {
    const auto kind = link == 1 ? TaskRow::Kind::kClearance1 : TaskRow::Kind::kClearance2;
    const double apart = disc.radius + disc.margin + to.robot.link.radius[static_cast<std::size_t>(link - 1)];
    to.add(kind, disc.center, apart, 0, task::kNone, apart, link);
  }
}

template <class Place>
void check(const Disc& disc, const Place& place) {
  task::check_point(place.at("center"), disc.center);
  task::check_between(place.at("radius"), disc.radius, 0, task::kLargestCoordinate, "m");
  task::check_between(place.at("margin"), disc.margin, 0, task::kLargestCoordinate, "m");
}

inline double relaxed_by(const Disc& disc) { return disc.radius + disc.margin; }
inline void relax(Disc& disc, double size) {
  disc.margin = std::min(disc.margin, size);
  disc.radius = size - disc.margin;
}

template <class Drawing>
void draw(const Disc& disc, Drawing& in) {
  in.disc(disc.center, disc.radius, disc.margin);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, Disc>
void visit(R& r, Visit&& v) {
  v(Key{"center", "m", "of the disc", kNeeded, "within 10 of the base"}, r.center);
  v(Key{"radius", "m", "of the disc", kNeeded, "0 to 10"}, r.radius);
  v(Key{"margin", "m", "kept beside radius and link", "0", "0 to 10"}, r.margin);
}

}  // namespace fjr
