#include "planner/problem/tip_path.h"

#include <cmath>

#include "planner/problem/task/task.h"

namespace fjr {
namespace {

constexpr int kPieces = 400;

template <class Path>
std::vector<Coordinates> points(const Path& path) {
  std::vector<Coordinates> result;
  for (int i = 0; i <= kPieces; ++i)
    result.push_back(along(path, path.from, path.to, static_cast<double>(i) / kPieces));
  return result;
}

}  // namespace

Coordinates along(const TipLine&, const Coordinates& from, const Coordinates& to, double fraction) {
  return {std::lerp(from[0], to[0], fraction), std::lerp(from[1], to[1], fraction)};
}

Coordinates along(const TipArc& arc, const Coordinates& from, const Coordinates& to, double fraction) {
  const double radius = std::hypot(arc.from[0] - arc.center[0], arc.from[1] - arc.center[1]);
  const double angle = angle_of(arc, from) + fraction * turn_between(arc, from, to);
  return {arc.center[0] + radius * std::cos(angle), arc.center[1] + radius * std::sin(angle)};
}

std::vector<Coordinates> points_along(const TipLine& line) { return points(line); }
std::vector<Coordinates> points_along(const TipArc& arc) { return points(arc); }

}  // namespace fjr
