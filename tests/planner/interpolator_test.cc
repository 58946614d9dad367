// Interpolation between the rows of a trajectory.
#include <gtest/gtest.h>

#include <utility>

#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

TEST(Interpolator, FollowsACubicExactlyAndItsTorqueLinearly) {
  const auto cubic = [](double t) { return 1 + t * (2 + t * (-3 + t * 4)); };
  const auto slope = [](double t) { return 2 + t * (-6 + t * 12); };
  Trajectory trajectory;
  for (const double t : {0.0, 0.3, 0.300001, 1.0}) {
    Sample row;
    row.time = t;
    row.state = {{cubic(t), 0}, {slope(t), 0}, {0, -cubic(t)}, {0, -slope(t)}};
    row.torque = {t < 0.3000005 ? t : 7 - t, 2 * t};
    trajectory.samples.push_back(row);
  }
  Interpolator at(trajectory);
  for (const double t : {0.9, 0.0, 0.1, 0.29, 0.3, 0.3000005, 0.31, 1.0, 0.5}) {  // in any order
    const Sample s = at.at(t);
    EXPECT_NEAR(s.state.q[0], cubic(t), 1e-14);
    EXPECT_NEAR(s.state.dq[0], slope(t), 1e-9);  // cancellation within the jump: 1e-16 / 1e-6
    EXPECT_NEAR(s.state.theta[1], -cubic(t), 1e-14);
    EXPECT_NEAR(s.state.dtheta[1], -slope(t), 1e-9);
    EXPECT_NEAR(s.torque[1], 2 * t, 1e-14);
    EXPECT_EQ(at.torque_at(t), s.torque);
  }
  EXPECT_NEAR(at.torque_at(0.15)[0], 0.15, 1e-15);
  EXPECT_NEAR(at.torque_at(0.7)[0], 6.3, 1e-12);
  EXPECT_EQ(at.at(-1).state.q[0], 1);
  EXPECT_NEAR(at.at(2).state.q[0], cubic(1), 1e-15);
  EXPECT_EQ(at.torque_at(2)[0], 6);
}

TEST(Interpolator, MeansAreExactOverJumpsAndBeyondTheEnds) {
  Trajectory trajectory;
  for (const auto& [time, tau] : {std::pair{1.0, 0.0}, {2.0, 2.0}, {2.000001, -2.0}, {3.0, 0.0}}) {
    Sample row;
    row.time = time;
    row.torque = {tau, 5};
    trajectory.samples.push_back(row);
  }
  Interpolator at(trajectory);
  EXPECT_NEAR(at.mean_torque(1, 2)[0], 1, 1e-12);
  EXPECT_NEAR(at.mean_torque(1, 3)[0], 0, 1e-6);
  EXPECT_NEAR(at.mean_torque(1.25, 1.75)[0], 1, 1e-12);
  EXPECT_NEAR(at.mean_torque(1.5, 2.5)[0], (0.75 - 0.75) / 1.0, 2e-6);
  EXPECT_NEAR(at.mean_torque(2.5, 4.5)[0], -0.125, 1e-6);  // zero after the end
  EXPECT_NEAR(at.mean_torque(0, 2)[0], 0.5, 1e-12);        // zero before the start
  EXPECT_NEAR(at.mean_torque(5, 6)[0], 0, 1e-15);
  EXPECT_NEAR(at.mean_torque(2.7, 2.7)[0], at.torque_at(2.7)[0], 1e-15);
  EXPECT_NEAR(at.mean_torque(0, 6)[1], 5, 1e-12);
}

}  // namespace
}  // namespace fjr
