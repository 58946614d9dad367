#include "model/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/dual.h"
#include "tests/support/arbitrary.h"

namespace fjr {
namespace {

const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

// All lengths below are under a metre and all velocities under 20 m/s: a few roundings.
constexpr double kRounding = 2e-14;

TEST(Kinematics, HangsStraightDownAtZeroAndTurnsCounterClockwise) {
  const auto tip = tip_position<double>(robot(), {0, 0});
  EXPECT_EQ(tip.x, 0);
  EXPECT_DOUBLE_EQ(tip.y, -0.65);
  const auto raised = tip_position<double>(robot(), {0.1, 0});
  EXPECT_GT(raised.x, 0);
  EXPECT_GT(raised.y, -0.65);
}

TEST(Kinematics, LinksKeepTheirLength) {
  const Joints<double> q{0.7, -1.9};
  const auto elbow = elbow_position(robot(), q), tip = tip_position(robot(), q);
  EXPECT_NEAR(std::hypot(elbow.x, elbow.y), robot().link.length[0], kRounding);
  EXPECT_NEAR(std::hypot(tip.x - elbow.x, tip.y - elbow.y), robot().link.length[1], kRounding);
}

RC_GTEST_PROP(Kinematics, TipVelocityIsTheDerivativeOfItsPosition, ()) {
  using D = Dual<1>;  // in time
  const Joints<double> q = pair_between(-3.2, 3.2), dq = pair_between(-8, 8);
  const D time = D::input(0, 0);
  const auto tip = tip_position<D>(robot(), {q[0] + dq[0] * time, q[1] + dq[1] * time});
  const auto velocity = tip_velocity(robot(), q, dq);
  RC_ASSERT(std::abs(velocity.x - tip.x.g[0]) < kRounding);
  RC_ASSERT(std::abs(velocity.y - tip.y.g[0]) < kRounding);
}

RC_GTEST_PROP(Kinematics, TipSpeedSquaredIsThatOfTheVelocity, ()) {
  const Joints<double> q = pair_between(-3.2, 3.2), dq = pair_between(-8, 8);
  const auto velocity = tip_velocity(robot(), q, dq);
  const double expected = velocity.x * velocity.x + velocity.y * velocity.y;
  RC_ASSERT(std::abs(tip_speed_squared(robot(), q[1], dq) - expected) < 10 * kRounding);
}

}  // namespace
}  // namespace fjr
