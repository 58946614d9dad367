// The flat map against the dynamics it inverts: dynamics(state, torque) must be the time derivative of the state.
#include "model/flatness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/taylor.h"

namespace fjr {
namespace {

// The paper's values, written out so that this test depends on no file. With link damping, which the paper leaves out.
Parameters robot_with_damping() {
  Parameters p{};
  p.link = {.length = {0.345, 0.305},
            .mass = {1.57, 0.66},
            .com_fraction = {0.742, 0.2687},
            .inertia = {0.0915, 7.1672e-3},
            .gravity_torque = {6.17, 0.53},
            .damping = {0.2516, 0.013},
            .radius = {0.03, 0.025}};
  p.spring.stiffness = {20.48, 17.75};
  p.motor.inertia = {0.0686, 0.0145};
  p.friction = {.viscous = {0.4968, 0.5051},
                .amplitude = {1.123, 0.8607},
                .width = {0.9505, 0.0174},
                .second_weight = {-0.7154, -0.1019},
                .second_shape = {-6539.2, 11.9636}};
  return p;
}

// offset + amplitude sin(rate t + phase), and its k-th derivative.
struct Sine {
  double offset, amplitude, rate, phase;
  double derivative(int k, double t) const {
    return (k == 0 ? offset : 0) +
           amplitude * std::pow(rate, k) * std::sin(rate * t + phase + k * std::numbers::pi / 2);
  }
};

LinkMotion motion_at(double t) {
  constexpr Sine kFirst[]{{0.3, 0.7, 2.1, 0.4}, {0, 0.2, 5.3, 1.7}};
  constexpr Sine kSecond[]{{-0.5, 0.9, 2.9, -0.8}, {0, 0.15, 6.1, 0.2}};
  const auto joints = [&](int k) {
    return Joints<double>{kFirst[0].derivative(k, t) + kFirst[1].derivative(k, t),
                          kSecond[0].derivative(k, t) + kSecond[1].derivative(k, t)};
  };
  return {joints(0), joints(1), joints(2), joints(3), joints(4)};
}

// Sixth-order central difference of component i of the flat state.
double state_rate(const Parameters& p, double t, int i) {
  constexpr double kStep = 2e-3, kWeights[] = {45.0 / 60, -9.0 / 60, 1.0 / 60};
  double rate = 0;
  for (int k = 1; k <= 3; ++k) {
    const FlatPoint after = from_link_motion(p, motion_at(t + k * kStep));
    const FlatPoint before = from_link_motion(p, motion_at(t - k * kStep));
    rate += kWeights[k - 1] * (after.state[i] - before.state[i]) / kStep;
  }
  return rate;
}

TEST(Flatness, DynamicsReturnTheTimeDerivativeOfTheFlatState) {
  const Parameters p = robot_with_damping();
  for (double t = 0; t < 3; t += 0.05) {
    const FlatPoint point = from_link_motion(p, motion_at(t));
    const State<double> rate = dynamics(p, point.state, point.torque);
    for (int i = 0; i < kStates; ++i) {
      EXPECT_NEAR(rate[i], state_rate(p, t, i), 1e-7) << "t = " << t << ", component " << i;
    }
  }
}

TEST(Flatness, CompensatedTorqueIsTheTorqueWithoutNonlinearFriction) {
  const Parameters p = robot_with_damping();
  const FlatPoint point = from_link_motion(p, motion_at(0.7));
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    EXPECT_DOUBLE_EQ(point.torque[i] - point.compensated_torque[i],
                     FrictionLaw::of(p, j).nonlinear(point.state.dtheta[i]));
  }
}

TEST(Flatness, LinkStateIsPassedThrough) {
  const LinkMotion motion = motion_at(1.1);
  const FlatPoint point = from_link_motion(robot_with_damping(), motion);
  EXPECT_EQ(point.state.q, motion.q);
  EXPECT_EQ(point.state.dq, motion.dq);
}

TEST(Flatness, RestIsTheStaticEquilibrium) {
  const Parameters p = robot_with_damping();
  const Joints<double> q{1.2, -0.8};
  const FlatPoint point = from_link_motion(p, {.q = q});
  const State<double> rest = rest_at(p, q);
  const Joints<double> gravity = gravity_torque(p, q);
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(point.state.theta[j], rest.theta[j], 1e-15);
    EXPECT_EQ(point.state.dtheta[j], 0);
    EXPECT_NEAR(point.torque[j], gravity[j], 1e-14);
  }
}

// f(t) = sin(a) b / (2 + cos(a)) with a = t + t^2/2 and b = 1 - t, derivatives at t = 0 by hand:
// sin(a) = t + t^2/2 - t^3/6 + O(t^4), cos(a) = 1 - t^2/2 - t^3/2 + O(t^4),
// 1/(2 + cos a) = 1/3 + t^2/18 + t^3/18 + O(t^4), product with b: t/3 - t^2/6 - t^3/6 + O(t^4).
TEST(Taylor, ProductsQuotientsAndSinesMatchASeriesWorkedOutByHand) {
  using Series = Taylor<3>;
  const Series a = Series::from_derivatives({0, 1, 1, 0}), b = Series::from_derivatives({1, -1, 0, 0});
  const Series f = sin(a) * b / (2.0 + cos(a));
  EXPECT_NEAR(f.derivative(0), 0, 1e-15);
  EXPECT_NEAR(f.derivative(1), 1.0 / 3, 1e-15);
  EXPECT_NEAR(f.derivative(2), -1.0 / 3, 1e-15);
  EXPECT_NEAR(f.derivative(3), -1.0, 1e-14);
}

TEST(Taylor, SquaredSineAndCosineAddUpToOne) {
  using Series = Taylor<5>;
  const Series a = Series::from_derivatives({0.7, -1.3, 2.1, 0.4, -0.9, 3.0});
  const Series one = sin(a) * sin(a) + cos(a) * cos(a);
  EXPECT_NEAR(one.c[0], 1, 1e-15);
  for (std::size_t k = 1; k <= 5; ++k) EXPECT_NEAR(one.c[k], 0, 1e-14) << k;
}

TEST(Taylor, CompoundAssignmentsAgreeWithTheirOperators) {
  using Series = Taylor<2>;
  const Series a = Series::from_derivatives({1, 2, 3}), b = Series::from_derivatives({4, -5, 6});
  Series r = a;
  r += b;
  r *= b;
  r -= a;
  r /= b;
  EXPECT_EQ(r.c, (((a + b) * b - a) / b).c);
  EXPECT_EQ((-a).c, (0.0 - a).c);
}

// There and back: the link motion is found again from the state and the torque alone.
TEST(Flatness, LinkMotionFollowsFromStateAndTorque) {
  const Parameters p = robot_with_damping();
  for (const double t : {0.0, 0.37, 0.81, 1.9}) {
    const LinkMotion motion = motion_at(t);
    const FlatPoint point = from_link_motion(p, motion);
    const LinkMotion again = link_motion(p, point.state, point.compensated_torque);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_EQ(again.q[j], motion.q[j]);
      EXPECT_EQ(again.dq[j], motion.dq[j]);
      // Every derivative divides rounding by the links' inertia once more: 1e-16 x 20 N m/rad / 0.03 kg m^2 = 1e-13.
      EXPECT_NEAR(again.ddq[j], motion.ddq[j], 1e-11);
      EXPECT_NEAR(again.dddq[j], motion.dddq[j], 1e-9);
      EXPECT_NEAR(again.ddddq[j], motion.ddddq[j], 1e-7);
    }
  }
}

}  // namespace
}  // namespace fjr
