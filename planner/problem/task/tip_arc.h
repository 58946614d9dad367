// The tip stays within a tolerance of an arc.
#pragma once

#include <optional>
#include <string>

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<TipArc>{.name = "tip_arc", .below = "tip", .is_band = true};

void add_rows(const TipArc& arc, TaskRows& to);
inline std::size_t count_of_rows(const TipArc& arc) { return arc.way == ArcWay::kLong ? 2 : 3; }

// Returns the angle [rad] of a point as seen from the centre.
double angle_of(const TipArc& arc, const Coordinates& point);
// Returns the angle [rad] that the arc turns by, counterclockwise positive.
double turn_of(const TipArc& arc);
// Returns the angle [rad] from one point to another as seen from the centre, in the direction of the arc.
double turn_between(const TipArc& arc, const Coordinates& from, const Coordinates& to);

// See TipPath in planner/problem/tip_path.h.
Coordinates along(const TipArc& arc, const Coordinates& from, const Coordinates& to, double fraction);

inline double relaxed_by(const TipArc& arc) { return arc.tolerance; }
inline void relax(TipArc& arc, double wider) { arc.tolerance = wider; }

template <class Drawing>
void draw(const TipArc& arc, Drawing& in) {
  const double begin = angle_of(arc, arc.from);
  in.arc(arc.center, task::distance(arc.from, arc.center), begin, begin + turn_of(arc), arc.tolerance);
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, TipArc>
void visit(R& r, Visit&& v) {
  v(Key{"center", "m", "of the circle", kNeeded}, r.center);
  v(Key{"from", "m", "one end", kNeeded}, r.from);
  v(Key{"to", "m", "the other end", kNeeded}, r.to);
  v(Key{"tolerance", "m", "distance from it", kNeeded, "0.0001 to 1"}, r.tolerance);
  v(Key{"way", "", "which way round", "`short`", "`short`: turns of up to 3 rad; `long`: up to 5.5 rad"}, r.way);
}

// ---- details of templates ----

namespace task {

// Fault of the arc's angle, if there is one. Half a turn has no short way, and a long way needs a gap that is left out.
struct FaultOfTurn {
  const char* key = "";  // that it belongs to; "": the arc itself
  std::string sentence;
};
std::optional<FaultOfTurn> fault_of_turn(const TipArc& arc, double radius);

}  // namespace task

template <class Place>
void check(const TipArc& arc, const Place& place) {
  task::check_point(place.at("center"), arc.center);
  task::check_point(place.at("from"), arc.from);
  task::check_point(place.at("to"), arc.to);
  task::check_tolerance(place, arc.tolerance, "m");
  const double radius = task::distance(arc.from, arc.center), other = task::distance(arc.to, arc.center);
  if (radius < task::kShortest) place.at("from").fail("is the center");
  if (std::abs(other - radius) > arc.tolerance) {
    place.at("to").fail(
        fmt::format("lies {:.6g} m from the center, from lies {:.6g} m from it; they may differ by the "
                    "tolerance of {} m",
                    other, radius, arc.tolerance));
  }
  if (task::distance(arc.from, arc.to) < task::kShortest) {
    place.at("to").fail("is the same point as from; a full circle has no short way");
  }
  const std::optional<task::FaultOfTurn> fault = task::fault_of_turn(arc, radius);
  if (!fault) return;
  if (*fault->key) place.at(fault->key).fail(fault->sentence);
  place.fail(fault->sentence);
}

}  // namespace fjr
