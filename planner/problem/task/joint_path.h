// The links' angles stay within a tolerance of straight lines.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

template <>
inline constexpr ConstraintInfo kInfo<JointPath>{.name = "path", .is_band = true, .unit = "rad"};

inline void add_rows(const JointPath& path, TaskRows& to) {
  task::add_band(to, TaskRow::Kind::kAngles, path.corners[to.segment], path.corners[to.segment + 1], path.tolerance);
}

template <class Place>
void check(const JointPath& path, const Place& place) {
  task::check_tolerance(place, path.tolerance, "rad");
}

inline double relaxed_by(const JointPath& path) { return path.tolerance; }
inline void relax(JointPath& path, double wider) { path.tolerance = wider; }

// Returns the tip's path along straight lines in joint space, which is curved.
inline std::vector<Coordinates> tip_curve(const Parameters& robot, const std::vector<Joints<double>>& corners) {
  constexpr int kPieces = 20;  // of each line
  std::vector<Coordinates> points;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Joints<double>&from = corners[i], &to = corners[i + 1];
    for (int k = 0; k <= kPieces; ++k) {
      const double fraction = static_cast<double>(k) / kPieces;
      const Joints<double> q{from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1])};
      const Point<double> tip = tip_position(robot, q);
      points.push_back({tip.x, tip.y});
    }
  }
  return points;
}

template <class Drawing>
void draw(const JointPath& path, Drawing& in) {
  in.curve(tip_curve(in.robot, path.corners));
}

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, JointPath>
void visit(R& r, Visit&& v) {
  v(Key{"corners", "rad", "from the start to the goal", kNeeded}, r.corners);
  v(Key{"tolerance", "rad", "of each angle", kNeeded, "0.0001 to 1"}, r.tolerance);
}

}  // namespace fjr
