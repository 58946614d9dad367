#include "planner/problem/inverse_kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fjr {
namespace {

constexpr double kSingular = 0.01;   // [rad] of q2 from 0 or pi
constexpr double kSameElbow = 1e-6;  // [rad] below it both elbows are one, and tell no side
constexpr double kRounding = 1e-8;   // of a cosine: tips on the edge of reach are within it

}  // namespace

std::array<double, 2> reach(const Parameters& robot) {
  const auto [l1, l2] = robot.link.length;
  return {std::abs(l1 - l2), l1 + l2};
}

std::vector<Joints<double>> inverse_kinematics(const Parameters& robot, const Coordinates& tip, Elbow elbow,
                                               const Limits& limits, const Joints<double>& near) {
  const auto [l1, l2] = robot.link.length;
  double cosine = (tip[0] * tip[0] + tip[1] * tip[1] - l1 * l1 - l2 * l2) / (2 * l1 * l2);
  if (std::abs(cosine) > 1 + kRounding) return {};
  cosine = std::clamp(cosine, -1.0, 1.0);
  const double bend = std::acos(cosine), direction = std::atan2(tip[0], -tip[1]);  // from hanging straight down
  std::vector<Joints<double>> found;
  const bool stretched = bend < kSameElbow;
  for (const double side : {-1.0, 1.0}) {  // the elbow is on the left when q2 < 0
    if (stretched ? side > 0 : elbow == (side < 0 ? Elbow::kRight : Elbow::kLeft)) continue;
    const double q2 = stretched ? 0 : side * bend;
    const double q1 = direction - std::atan2(l2 * std::sin(q2), l1 + l2 * std::cos(q2));
    for (int turn = -2; turn <= 2; ++turn) {
      const Joints<double> q{q1 + 2 * std::numbers::pi * turn, q2};
      const auto within = [&](std::size_t j) { return q[j] >= limits.lowest(j) && q[j] <= limits.highest(j); };
      if (within(0) && within(1)) found.push_back(q);
    }
  }
  std::stable_sort(found.begin(), found.end(), [&](const Joints<double>& a, const Joints<double>& b) {
    return largest_difference(a, near) < largest_difference(b, near);
  });
  return found;
}

std::optional<Joints<double>> inverse_velocity(const Parameters& robot, const Joints<double>& q,
                                               const Coordinates& velocity) {
  const auto [l1, l2] = robot.link.length;
  if (std::abs(std::sin(q[1])) < std::sin(kSingular)) return std::nullopt;
  // (v_x, v_y) = dq1 (l1 cos q1, l1 sin q1) + (dq1 + dq2) (l2 cos(q1 + q2), l2 sin(q1 + q2)); Cramer's rule.
  const double a = q[0], b = q[0] + q[1], determinant = l1 * l2 * std::sin(q[1]);
  const double first = l2 * (velocity[0] * std::sin(b) - velocity[1] * std::cos(b)) / determinant;
  const double both = l1 * (velocity[1] * std::cos(a) - velocity[0] * std::sin(a)) / determinant;
  return Joints<double>{first, both - first};
}

}  // namespace fjr
