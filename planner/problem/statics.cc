#include "planner/problem/statics.h"

#include <cmath>
#include <vector>

namespace fjr {

Carrying carrying(const Problem& problem) {
  constexpr int kPieces = 200;
  const std::vector<Joints<double>> points = waypoints(problem);
  Carrying most;
  for (std::size_t s = 0; s + 1 < points.size(); ++s) {
    for (int i = 0; i <= kPieces; ++i) {
      Joints<double> q{};
      for (std::size_t j = 0; j < kJoints; ++j) q[j] = std::lerp(points[s][j], points[s + 1][j], i / double{kPieces});
      const Joints<double> gravity = gravity_torque(problem.robot, q);
      for (std::size_t j = 0; j < kJoints; ++j) {
        Limits& needed = most.needed;
        if (!(std::abs(gravity[j]) > needed.torque[j])) continue;
        needed.torque[j] = std::abs(gravity[j]);
        needed.spring_deflection[j] = needed.torque[j] / problem.robot.spring.stiffness[j];
        most.posture[j] = q;
      }
    }
  }
  return most;
}

}  // namespace fjr
