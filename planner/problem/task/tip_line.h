// The tip stays within a tolerance of a straight line.
#pragma once

#include <cmath>

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<TipLine>{.name = "tip_line", .below = "tip", .is_band = true};

inline void add_rows(const TipLine& line, TaskRows& to) {
  task::add_band(to, TaskRow::Kind::kTip, line.from, line.to, line.tolerance);
}

template <class Place>
void check(const TipLine& line, const Place& place) {
  task::check_point(place.at("from"), line.from);
  task::check_point(place.at("to"), line.to);
  task::check_tolerance(place, line.tolerance, "m");
  if (task::distance(line.from, line.to) < task::kShortest) place.at("to").fail("is the same point as from");
}

inline double relaxed_by(const TipLine& line) { return line.tolerance; }
inline void relax(TipLine& line, double wider) { line.tolerance = wider; }

// See TipPath in planner/problem/tip_path.h.
inline Coordinates along(const TipLine&, const Coordinates& from, const Coordinates& to, double fraction) {
  return {std::lerp(from[0], to[0], fraction), std::lerp(from[1], to[1], fraction)};
}

template <class Drawing>
void draw(const TipLine& line, Drawing& in) {
  in.line(line.from, line.to, line.tolerance);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, TipLine>
void visit(R& r, Visit&& v) {
  v(Key{"from", "m", "one end", kNeeded}, r.from);
  v(Key{"to", "m", "the other end", kNeeded}, r.to);
  v(Key{"tolerance", "m", "distance from it", kNeeded, "0.0001 to 1"}, r.tolerance);
}

}  // namespace fjr
