// The tip stays within a tolerance of an arc.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

enum class ArcWay { kShort, kLong };

// About `center`, the short way from one point to another, or the long way round. [m]
struct TipArc {
  Coordinates center{}, from{}, to{};
  double tolerance = 0;
  ArcWay way = ArcWay::kShort;

  static constexpr ConstraintInfo info{.name = "tip_arc"};

  void add_rows(TaskRows& rows) const;
  std::size_t count_of_rows() const { return way == ArcWay::kLong ? 2 : 3; }

  template <class Place>
  void check(const Place& place) const;

  double relaxed_by() const { return tolerance; }
  void relax(double wider) { tolerance = wider; }

  template <class Drawing>
  void draw(Drawing& in) const {
    const double begin = std::atan2(from[1] - center[1], from[0] - center[0]);
    in.arc(center, task::distance(from, center), begin, begin + turn(), tolerance);
  }

  // Of a point as seen from the centre. [rad]
  double angle_of(const Coordinates& point) const;
  // The angle that it turns by, counterclockwise positive. [rad]
  double turn() const;
};

// The angle from one point to another as seen from the centre, the way round that the arc goes. [rad]
double turn_between(const TipArc& arc, const Coordinates& from, const Coordinates& to);

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

// What is wrong with how far it turns, and of which key; empty where nothing is. Half a turn has no short way, and a
// long way needs a gap that is left out.
struct FaultOfTurn {
  const char* key = "";
  std::string sentence;
};
FaultOfTurn fault_of_turn(const TipArc& arc, double radius);

}  // namespace task

template <class Place>
void TipArc::check(const Place& place) const {
  task::check_point(place.at("center"), center);
  task::check_point(place.at("from"), from);
  task::check_point(place.at("to"), to);
  task::check_tolerance(place, tolerance, "m");
  const double radius = task::distance(from, center), other = task::distance(to, center);
  if (radius < task::kShortest) place.at("from").fail("is the center");
  if (std::abs(other - radius) > tolerance) {
    place.at("to").fail(
        fmt::format("lies {:.6g} m from the center, from lies {:.6g} m from it; they may differ by the "
                    "tolerance of {} m",
                    other, radius, tolerance));
  }
  if (task::distance(from, to) < task::kShortest) {
    place.at("to").fail("is the same point as from; a full circle has no short way");
  }
  const task::FaultOfTurn fault = task::fault_of_turn(*this, radius);
  if (fault.sentence.empty()) return;
  if (*fault.key) place.at(fault.key).fail(fault.sentence);
  place.fail(fault.sentence);
}

}  // namespace fjr
