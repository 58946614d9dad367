// A motion from rest to rest by flatness, for tests that need some trajectory at once.
#pragma once

#include <cmath>

#include "model/flatness.h"
#include "planner/protocol/execution_messages.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// 126 s^5 - 420 s^6 + 540 s^7 - 315 s^8 + 70 s^9: from 0 to 1 with four zero derivatives at both ends. The k-th one.
inline double smooth_step(double s, int k) {
  constexpr double kCoefficients[] = {126, -420, 540, -315, 70};
  double sum = 0;
  for (int i = 5; i < 10; ++i) {
    double factor = kCoefficients[i - 5];
    for (int r = 0; r < k; ++r) factor *= i - r;
    sum += factor * std::pow(s, i - k);
  }
  return sum;
}

inline Trajectory flat_motion(const Parameters& robot, const Joints<double>& from, const Joints<double>& to,
                              double duration) {
  Trajectory trajectory;
  const int rows = static_cast<int>(std::lround(duration / 1e-3));
  for (int i = 0; i <= rows; ++i) {
    const double s = static_cast<double>(i) / rows;
    const auto derivative = [&](int k) {
      Joints<double> value;
      for (std::size_t j = 0; j < kJoints; ++j) {
        value[j] = (k == 0 ? from[j] : 0) + (to[j] - from[j]) * smooth_step(s, k) / std::pow(duration, k);
      }
      return value;
    };
    const LinkMotion motion{derivative(0), derivative(1), derivative(2), derivative(3), derivative(4)};
    const FlatPoint point = from_link_motion(robot, motion);
    trajectory.samples.push_back({duration * s, point.state, point.torque});
  }
  for (Sample* end : {&trajectory.samples.front(), &trajectory.samples.back()}) {  // rounding is no motion
    end->state = rest_at(robot, end->state.q);
    end->torque = gravity_torque(robot, end->state.q);
  }
  return trajectory;
}

}  // namespace fjr
