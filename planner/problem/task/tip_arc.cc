#include "planner/problem/task/tip_arc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fjr {
namespace {

using namespace task;
using Kind = TaskRow::Kind;

constexpr double kMostTurn = 3.0;      // [rad] largest angle the short way: half a turn has no short way
constexpr double kMostLongTurn = 5.5;  // [rad] largest angle the long way: a gap has to be left
constexpr double kSameHalf = 1e-6;     // [rad] from half a turn, which has no long way either
constexpr double kGapTolerances = 4;   // least width of the gap left by a long arc

// For an arc of more than half a turn, lines across its ends would cut the arc itself. The gap that it leaves of the
// circle, less than half a turn, is barred by a disc about its middle that reaches nearly to both ends.
void add_gap(TaskRows& rows, const TipArc& arc, double radius) {
  const Coordinates chord{(arc.from[0] + arc.to[0]) / 2 - arc.center[0], (arc.from[1] + arc.to[1]) / 2 - arc.center[1]};
  const Coordinates middle{arc.center[0] + chord[0] * radius / length(chord),
                           arc.center[1] + chord[1] * radius / length(chord)};
  const double apart =
      std::min(length(difference(arc.from, middle)), length(difference(arc.to, middle))) - kBeyond * arc.tolerance;
  rows.add(Kind::kTipRadius, middle, apart, 0, kNone, arc.tolerance);
}

// Adds the rows of an arc: near the circle, after the line across it at one end and before the line at the other.
void add_arc(TaskRows& rows, const TipArc& arc) {
  const Coordinates first = difference(arc.from, arc.center), last = difference(arc.to, arc.center);
  const double radius = length(first), band = kAcross * arc.tolerance, beyond = kBeyond * arc.tolerance;
  const auto from_circle = [radius](double r) { return (r * r - radius * radius) / (2 * radius); };
  rows.add(Kind::kTipRadius, arc.center, radius, radius > band ? from_circle(radius - band) : -kNone,
           from_circle(radius + band), arc.tolerance);
  if (arc.way == ArcWay::kLong) return add_gap(rows, arc, radius);
  const double turn = first[0] * last[1] - first[1] * last[0] > 0 ? 1 : -1;
  const auto onward = [turn](const Coordinates& r) {
    return Coordinates{-turn * r[1] / length(r), turn * r[0] / length(r)};
  };
  const Coordinates at_from = onward(first), at_to = onward(last);
  rows.add(Kind::kTip, at_from, dot(at_from, arc.from), -beyond, kNone, arc.tolerance);
  rows.add(Kind::kTip, at_to, dot(at_to, arc.to), -kNone, beyond, arc.tolerance);
}

}  // namespace

void add_rows(const TipArc& arc, TaskRows& to) { add_arc(to, arc); }

double turn_between(const TipArc& arc, const Coordinates& from, const Coordinates& to) {
  const auto shortest = [](double angle) { return std::remainder(angle, 2 * std::numbers::pi); };
  const double turn = shortest(angle_of(arc, to) - angle_of(arc, from));
  if (arc.way == ArcWay::kShort) return turn;
  // Counts against the short way up to 0.9 whole turns; the rest is for points that lie a little before the other one.
  const double onward =
      -std::copysign(0.9 * std::numbers::pi, shortest(angle_of(arc, arc.to) - angle_of(arc, arc.from)));
  return std::remainder(turn - onward, 2 * std::numbers::pi) + onward;
}

double angle_of(const TipArc& arc, const Coordinates& point) {
  return std::atan2(point[1] - arc.center[1], point[0] - arc.center[0]);
}

double turn_of(const TipArc& arc) { return turn_between(arc, arc.from, arc.to); }

Coordinates along(const TipArc& arc, const Coordinates& from, const Coordinates& to, double fraction) {
  const double radius = std::hypot(arc.from[0] - arc.center[0], arc.from[1] - arc.center[1]);
  const double angle = angle_of(arc, from) + fraction * turn_between(arc, from, to);
  return {arc.center[0] + radius * std::cos(angle), arc.center[1] + radius * std::sin(angle)};
}

std::optional<task::FaultOfTurn> task::fault_of_turn(const TipArc& arc, double radius) {
  const bool is_long = arc.way == ArcWay::kLong;
  const double turn = std::abs(turn_of(arc)), most = is_long ? kMostLongTurn : kMostTurn;
  const bool is_half = std::abs(turn - std::numbers::pi) < kSameHalf;
  if (is_long && is_half) {
    return FaultOfTurn{"", "is half a turn, which goes either way round; move `to` by a millimetre, to say which"};
  }
  if (turn > most) {
    const char* const instead = is_long ? ""
                                : is_half
                                    ? "; way: long takes it, with `to` a millimetre beside, to say which way round"
                                    : "; way: long is the other way round";
    return FaultOfTurn{"", fmt::format("turns by {:.4g} rad, above the {} rad allowed{}", turn, most, instead)};
  }
  const double gap = (2 * std::numbers::pi - turn) * radius;
  if (is_long && (gap < kGapTolerances * arc.tolerance || arc.tolerance > radius / 2)) {
    return FaultOfTurn{
        "tolerance", fmt::format("{} m is too wide for an arc that leaves {:.4g} m of its circle", arc.tolerance, gap)};
  }
  return std::nullopt;
}

}  // namespace fjr
