// The tip stays inside a box.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<TipBox>{
    .name = "tip_box", .below = "tip", .relaxed = "{} m larger on every side"};

inline void add_rows(const TipBox& box, TaskRows& to) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Coordinates axis{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0};
    to.add(TaskRow::Kind::kTip, axis, 0, box.lower[i], box.upper[i], task::kArmScale);
  }
}

template <class Place>
void check(const TipBox& box, const Place& place) {
  task::check_point(place.at(0), box.lower);
  task::check_point(place.at(1), box.upper);
  for (std::size_t i = 0; i < 2; ++i) {
    if (box.upper[i] - box.lower[i] >= task::kShortest) continue;
    place.at(1).at(i).fail(fmt::format("{} m is not above the first corner's {} m (lower left first, then upper right)",
                                       box.upper[i], box.lower[i]));
  }
}

// Returns the growth of a box on every side, from which relaxing counts. [m]
inline double relaxed_by(const TipBox&) { return 0; }
inline void relax(TipBox& box, double by) {
  for (std::size_t i = 0; i < 2; ++i) {
    box.lower[i] -= by;
    box.upper[i] += by;
  }
}

template <class Drawing>
void draw(const TipBox& box, Drawing& in) {
  in.box(box.lower, box.upper);
}

}  // namespace fjr
