// The tip stays inside a box.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

// [m]
struct TipBox {
  Coordinates lower{}, upper{};

  static constexpr ConstraintInfo info{.name = "tip_box", .relaxed = "{} m larger on every side"};

  void add_rows(TaskRows& to) const {
    constexpr double kScale = 0.1;  // [m] a box has no size of its own that matters: the arm's
    for (std::size_t i = 0; i < 2; ++i) {
      const Coordinates axis{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0};
      to.add(TaskRow::Kind::kTip, axis, 0, lower[i], upper[i], kScale);
    }
  }

  template <class Place>
  void check(const Place& place) const {
    task::check_point(place.at(0), lower);
    task::check_point(place.at(1), upper);
    for (std::size_t i = 0; i < 2; ++i) {
      if (upper[i] - lower[i] >= task::kShortest) continue;
      place.at(1).at(i).fail(fmt::format(
          "{} m is not above the first corner's {} m (lower left first, then upper right)", upper[i], lower[i]));
    }
  }

  // What it grows by on every side. [m]
  double relaxed_by() const { return 0; }
  void relax(double by) {
    for (std::size_t i = 0; i < 2; ++i) {
      lower[i] -= by;
      upper[i] += by;
    }
  }

  template <class Drawing>
  void draw(Drawing& in) const {
    in.box(lower, upper);
  }
};

}  // namespace fjr
