#include "planner/problem/tip_path.h"

#include <cmath>
#include <numbers>

namespace fjr {
namespace {

constexpr int kPieces = 400;

double angle_of(const TipArc& arc, const Pair<double>& point) {
  return std::atan2(point[1] - arc.center[1], point[0] - arc.center[0]);
}

// From one angle to another, the way round that the arc goes.
double turn_between(const TipArc& arc, const Pair<double>& from, const Pair<double>& to) {
  const auto shortest = [](double angle) { return std::remainder(angle, 2 * std::numbers::pi); };
  const double turn = shortest(angle_of(arc, to) - angle_of(arc, from));
  if (arc.way == ArcWay::kShort) return turn;
  // Against the short way, by up to 0.9 whole turns; what is left is for points that lie a little before the other.
  const double onward =
      -std::copysign(0.9 * std::numbers::pi, shortest(angle_of(arc, arc.to) - angle_of(arc, arc.from)));
  return std::remainder(turn - onward, 2 * std::numbers::pi) + onward;
}

template <class Path>
std::vector<Pair<double>> points(const Path& path) {
  std::vector<Pair<double>> result;
  for (int i = 0; i <= kPieces; ++i)
    result.push_back(along(path, path.from, path.to, static_cast<double>(i) / kPieces));
  return result;
}

}  // namespace

Pair<double> along(const TipLine&, const Pair<double>& from, const Pair<double>& to, double share) {
  return {std::lerp(from[0], to[0], share), std::lerp(from[1], to[1], share)};
}

Pair<double> along(const TipArc& arc, const Pair<double>& from, const Pair<double>& to, double share) {
  const double radius = std::hypot(arc.from[0] - arc.center[0], arc.from[1] - arc.center[1]);
  const double angle = angle_of(arc, from) + share * turn_between(arc, from, to);
  return {arc.center[0] + radius * std::cos(angle), arc.center[1] + radius * std::sin(angle)};
}

double turn_of(const TipArc& arc) { return turn_between(arc, arc.from, arc.to); }

std::vector<Pair<double>> points_along(const TipLine& line) { return points(line); }
std::vector<Pair<double>> points_along(const TipArc& arc) { return points(arc); }

}  // namespace fjr
