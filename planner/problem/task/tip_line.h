// The tip stays within a tolerance of a straight line.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

// Between two points. [m]
struct TipLine {
  Coordinates from{}, to{};
  double tolerance = 0;

  static constexpr ConstraintInfo info{.name = "tip_line"};

  void add_rows(TaskRows& rows) const { task::add_band(rows, TaskRow::Kind::kTip, from, to, tolerance); }

  template <class Place>
  void check(const Place& place) const {
    task::check_point(place.at("from"), from);
    task::check_point(place.at("to"), to);
    task::check_tolerance(place, tolerance, "m");
    if (task::distance(from, to) < task::kShortest) place.at("to").fail("is the same point as from");
  }

  double relaxed_by() const { return tolerance; }
  void relax(double wider) { tolerance = wider; }

  template <class Drawing>
  void draw(Drawing& in) const {
    in.line(from, to, tolerance);
  }
};

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, TipLine>
void visit(R& r, Visit&& v) {
  v(Key{"from", "m", "one end", kNeeded}, r.from);
  v(Key{"to", "m", "the other end", kNeeded}, r.to);
  v(Key{"tolerance", "m", "distance from it", kNeeded, "0.0001 to 1"}, r.tolerance);
}

}  // namespace fjr
