// The links' angles stay within a tolerance of straight lines.
#pragma once

#include "planner/problem/task/constraint.h"

namespace fjr {

// Through the corners, one after the other. The motion has one segment per line. [rad]
struct JointPath {
  std::vector<Joints<double>> corners;  // from the start to the goal
  double tolerance = 0;

  static constexpr ConstraintInfo info{.name = "path", .unit = "rad"};

  void add_rows(TaskRows& to) const {
    task::add_band(to, TaskRow::Kind::kAngles, corners[to.segment], corners[to.segment + 1], tolerance);
  }

  template <class Place>
  void check(const Place& place) const {
    task::check_tolerance(place, tolerance, "rad");
  }

  double relaxed_by() const { return tolerance; }
  void relax(double wider) { tolerance = wider; }

  template <class Drawing>
  void draw(Drawing& in) const {
    in.joint_lines(corners);
  }
};

template <class R, class Visit>
requires std::is_same_v<std::remove_const_t<R>, JointPath>
void visit(R& r, Visit&& v) {
  v(Key{"corners", "rad", "from the start to the goal", kNeeded}, r.corners);
  v(Key{"tolerance", "rad", "of each angle", kNeeded, "0.0001 to 1"}, r.tolerance);
}

}  // namespace fjr
