// Certificates of arms at rest, where motor 2's friction amplifies errors, upright, where gravity does, and of motions
// that begin elsewhere than exactly at their start.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/certificate/amplification.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/comparison.h"
#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/control/motor_feedback.h"
#include "support/exact_trajectories.h"
#include "support/linearised_arm.h"

namespace fjr {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Amplification, BandIsWhereTheCompleteLawFalls) {
  EXPECT_EQ(FrictionLaw::of(robot(), 0).unstable_band(), 0);
  const FrictionLaw second = FrictionLaw::of(robot(), 1);
  const double band = second.unstable_band();
  EXPECT_NEAR(band, 5.08e-4, 1e-6);
  EXPECT_NEAR(second.torque(band), -1.77e-3, 1e-5);
}

// det(s I - A) is zero at the largest real eigenvalue and positive beyond it.
TEST(Amplification, GrowthRateIsTheLargestRealEigenvalueOfTheCompleteArm) {
  for (const Joints<double> q : {Joints<double>{pi, 0}, {2.0, 0.3}, {1.8, -1.0}, {0.2, pi}, {0.3, 0.4}}) {
    const Eigen::MatrixXd a = linearised_arm(q);
    const auto characteristic = [&](double s) {
      return (s * Eigen::MatrixXd::Identity(kStates, kStates) - a).partialPivLu().determinant();
    };
    const double rate = gravity_growth_rate(robot(), q);
    if (rate > 0) {
      EXPECT_LT(characteristic(rate - 1e-4), 0) << q[0] << ", " << q[1];
    }
    for (double s = rate + 1e-4; s < 1e3; s *= 1.05) EXPECT_GT(characteristic(s), 0) << q[0] << ", " << q[1];
  }
  EXPECT_NEAR(gravity_growth_rate(robot(), {pi, 0}), 4.2, 0.05);
  EXPECT_EQ(gravity_growth_rate(robot(), {0.3, 0.4}), 0);
}

// At q with motors that move out of their bands, for `duration`.
Trajectory moving_at(const Joints<double>& q, double duration) {
  Trajectory trajectory = resting(q, duration);
  in_every_row([](Sample& row) { row.state.dtheta = {0.01, 0.01}; })(trajectory.samples);
  return trajectory;
}

TEST(Amplification, LongRestsOfMotorTwoAndLongStaysUprightAreStretches) {
  EXPECT_THAT(stretches_of_amplification(robot(), resting({0.3, 0.2}, 0.09)), IsEmpty());
  const std::vector<Stretch> rest = stretches_of_amplification(robot(), resting({0.3, 0.2}, 0.3));
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].from, 0);
  EXPECT_EQ(rest[0].to, 0.3);
  EXPECT_EQ(rest[0].joint, 2);
  EXPECT_THAT(rest[0].why, HasSubstr("motor 2 rests from 0.000 s"));
  EXPECT_THAT(stretches_of_amplification(robot(), moving_at({pi, 0}, 0.5)), IsEmpty());
  EXPECT_THAT(stretches_of_amplification(robot(), moving_at({1.0, 0}, 10.0)), IsEmpty());
}

// 4.2/s upright: e^3 every 0.72 s.
TEST(Amplification, GravityAsksForARunOfItsOwnWheneverItHasAmplifiedTwentyfold) {
  const std::vector<Stretch> upright = stretches_of_amplification(robot(), moving_at({pi, 0}, 2.0));
  ASSERT_EQ(upright.size(), 2u);
  EXPECT_NEAR(upright[0].from, 3 / 4.2, 0.02);
  EXPECT_EQ(upright[0].to, upright[0].from);
  EXPECT_NEAR(upright[1].to, 2 * upright[0].to, 0.02);
  EXPECT_THAT(upright[1].why, HasSubstr("upright"));
}

TEST(Amplification, EveryRestIsAStretchOfItsOwn) {
  Trajectory trajectory = resting({0.3, 0.2}, 1);
  for (std::size_t k = 200; k < 400; ++k) trajectory.samples[k].state.dtheta[1] = 0.1;
  for (std::size_t k = 450; k < 600; ++k) trajectory.samples[k].state.dtheta[1] = 0.1;  // 0.05 s after the one before
  const std::vector<Stretch> rests = stretches_of_amplification(robot(), trajectory);
  ASSERT_EQ(rests.size(), 2u);
  EXPECT_NEAR(rests[0].to, 0.199, 1e-12);
  EXPECT_NEAR(rests[1].from, 0.6, 1e-12);
  EXPECT_NEAR(rests[1].to, 1, 1e-12);
}

void append(Trajectory& trajectory, const Trajectory& more) {
  const double from = trajectory.end_time();
  for (std::size_t k = 1; k < more.samples.size(); ++k) {
    trajectory.samples.push_back(more.samples[k]);
    trajectory.samples.back().time += from;
  }
}

// What rests so long that no open-loop run across it is exact says nothing about what comes after: motor 1's torque is
// 0.2 % too large there, which is refused as it is without the rest.
TEST(Certificate, ALongRestExcusesNothingElse) {
  for (const double torque : {1.0, 1.002}) {
    Trajectory rest_first = resting({0.1, -0.2}, 0.11), motion = reference_trajectory();
    in_every_row([&](Sample& row) { row.torque[0] *= torque; })(motion.samples);
    motion.samples.front().torque = rest_first.samples.back().torque;
    append(rest_first, motion);
    const Certificate c = certificate_of(rest_first);
    ASSERT_EQ(c.open_loop.stretches.size(), 1u);
    EXPECT_EQ(c.certified, torque == 1) << testing::PrintToString(c.failures);
    if (torque != 1) {
      EXPECT_THAT(c.failures, testing::Contains(HasSubstr("open loop: link")));
    }
  }
}

// Motor 2 stands still while link 1 swings: tau2 is what its spring pulls with, tau1 is smooth.
Trajectory swing_with_motor_two_at_rest(double duration) {
  Trajectory trajectory;
  State<double> x = rest_at(robot(), {0.1, -0.2});
  const auto torque = [](double t, const State<double>& at) {
    return Joints<double>{smooth_torque(t)[0], spring_torque(robot(), at.q, at.theta)[1]};
  };
  trajectory.samples.push_back({0, x, torque(0, x)});
  const double still = x.theta[1];
  constexpr double kStep = 1e-6;  // [s] motor 1 passes through the friction step in 60 of these
  for (int k = 1; k * kStep <= duration + 1e-9; ++k) {
    x = runge_kutta_step(torque, (k - 1) * kStep, x, kStep);
    x.theta[1] = still;
    x.dtheta[1] = 0;
    if (k % 1000 == 0) trajectory.samples.push_back({k * kStep, x, torque(k * kStep, x)});
  }
  return trajectory;
}

TEST(Certificate, WhileOneMotorRestsTheOtherIsStillInOpenLoop) {
  for (const double torque : {1.0, 1.002}) {
    Trajectory trajectory = swing_with_motor_two_at_rest(0.2);
    in_every_row([&](Sample& row) { row.torque[0] *= torque; })(trajectory.samples);
    const Certificate c = certificate_of(trajectory);
    ASSERT_EQ(c.open_loop.stretches.size(), 1u);
    EXPECT_EQ(c.open_loop.stretches[0].to, trajectory.end_time());
    EXPECT_EQ(c.certified, torque == 1) << testing::PrintToString(c.failures);
    if (torque != 1) {
      EXPECT_THAT(c.failures, testing::Contains(HasSubstr("open loop: link 1")));
    }
  }
}

TEST(Certificate, RestOfMotorTwoIsCertifiedInClosedLoop) {
  Trajectory trajectory = resting({0.5, 0.3}, 0.3);
  trajectory.samples.front().state.dtheta[1] += 1e-9;  // the seed of the instability
  const Certificate c = certificate_of(trajectory);
  EXPECT_THAT(c.failures, IsEmpty());
  EXPECT_THAT(c.open_loop.why_not_in_one_run(), HasSubstr("motor 2 rests"));
  EXPECT_TRUE(c.residual.evaluated);
  EXPECT_EQ(c.residual.window, 1.0);
  // Feedback bounds what open loop lets run away: friction pushes at most 1.77e-3 N m around rest.
  EXPECT_LT(c.residual.link_vibration[1], 2e-4);
  EXPECT_GT(c.residual.open_loop_drift[1], 5e-4);
}

TEST(Certificate, RestOfMotorOneNeedsNoExcuse) {
  Trajectory trajectory = resting({0.5, 0.3}, 0.09);
  const Certificate c = certificate_of(trajectory);
  EXPECT_TRUE(c.certified);
  EXPECT_THAT(c.open_loop.stretches, IsEmpty());
}

// Without the dither motor 2 leaves its rest for a limit cycle of 1.03 counts, from whatever start that is not exactly
// the rest.
TEST(Certificate, ARestThatTheExecutorHoldsIsCertifiedHoweverLong) {
  for (const Joints<double> q : {Joints<double>{0, 0}, {0.5, 0.3}}) {
    for (const double off : {1e-12, 1e-9}) {
      Trajectory trajectory = resting(q, 1);
      trajectory.samples.front().state.theta[1] += off;
      const Certificate c = certificate_of(trajectory);
      EXPECT_THAT(c.failures, IsEmpty()) << q[0] << ", " << off;
      EXPECT_LT(c.closed_loop.max_link(), 0.2 * c.tolerance);  // 0.06, of the swing
      EXPECT_LT(c.closed_loop.perturbed.max_link(), 0.6 * c.tolerance);
    }
  }
}

// ---- from elsewhere than exactly the start ----

// A drive that cannot give what gravity takes: on the way the arm is rolled out with the executor's law, of which that
// is a part, and the links fall.
TEST(Certificate, ARestOnTheWayIsHeldAsTheExecutorDoes) {
  Parameters weak = robot();
  const Trajectory trajectory = resting({0.5, 0.3}, 0.1);
  EXPECT_LT(roll_out_perturbed(weak, trajectory).max_link(), 0.6 * exactness_tolerance(weak));
  weak.drive.peak_torque[0] = 0.5 * trajectory.samples.front().torque[0];
  EXPECT_GT(roll_out_perturbed(weak, trajectory).max_link(), 10 * exactness_tolerance(weak));
}

// The executor holds the arm from each of the five ends.
TEST(Certificate, AfterTheEndTheWorstOfAllEndsCounts) {
  const Trajectory trajectory = resting({1.2, -0.8}, 0.02);
  const Sample &first = trajectory.samples.front(), &last = trajectory.samples.back();
  Joints<double> worst{};
  for (const Joints<double> signs : {Joints<double>{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1e-3, 1e-3}}) {
    Rollout arm(robot(), Limits{}, Accuracy::of_predictions());
    arm.limit_step(longest_step(trajectory));
    arm.start(0, moved(first.state, {signs[0] / 2, signs[1] / 2}), Drive::closed_loop(trajectory, robot()));
    ASSERT_TRUE(arm.run(last.time, {}, torque_corners(trajectory, kCorner), {}));
    const Joints<double> after = deviation_at_rest(robot(), last, arm.state());
    for (std::size_t j = 0; j < kJoints; ++j) worst[j] = std::max(worst[j], after[j]);
  }
  const Perturbed told = roll_out_perturbed(robot(), trajectory);
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(told.after[j], worst[j], 1e-7);  // of 1e-4 that is judged
}

// Rows that are exact at rest would hide how far the arm comes off within a second of it.
TEST(Certificate, ARestIsJudgedTheSameHoweverExactItsRowsAre) {
  for (const double off : {0.0, 1e-12}) {
    for (const double duration : {0.2, 1.0}) {
      Trajectory trajectory = resting({0, 0}, duration);
      trajectory.samples.front().state.theta[0] += off;
      const Certificate c = certificate_of(trajectory);
      EXPECT_THAT(c.failures, IsEmpty()) << off << ", " << duration;
      EXPECT_GT(c.closed_loop.perturbed.link[0], 0.49 * c.tolerance);
    }
  }
}

// Friction that falls with speed up to where no dither within a tenth of a count can reach: nobody could hold it.
TEST(Certificate, AnArmThatWandersAfterTheEndIsRefused) {
  Parameters sticky = robot();
  sticky.friction.second_weight[1] *= 4;
  const Certificate c = certify(sticky, robot_limits(), resting({0, 0}, 0.02));
  EXPECT_FALSE(c.certified);
  EXPECT_THAT(c.failures, ElementsAre(AllOf(HasSubstr("link 2"), HasSubstr("in the second after the end"))));
}

TEST(Certificate, FromHalfACountOffAgreesWithFixedSteps) {
  const Trajectory& trajectory = reference_trajectory();
  const Drive closed = Drive::closed_loop(trajectory, robot());
  Joints<double> worst{};
  for (const Joints<double> signs : {Joints<double>{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
    Interpolator plan(trajectory);
    const TorqueLaw tau = [&](double t, const State<double>& x) {
      const Sample planned = plan.at(t);
      const Joints<double> f = closed.feedback(planned.state, x);
      return Joints<double>{planned.torque[0] + f[0], planned.torque[1] + f[1]};
    };
    State<double> x = trajectory.samples.front().state;
    for (std::size_t j = 0; j < kJoints; ++j) {
      x.q[j] += signs[j] * pi / 65536;
      x.theta[j] += signs[j] * pi / 65536;
    }
    constexpr double kStep = 1e-6;  // [s]
    for (int k = 0; k < 430'000; ++k) {
      x = runge_kutta_step(tau, k * kStep, x, kStep);
      if (k % 1000 != 999) continue;
      const State<double> planned = trajectory.samples[static_cast<std::size_t>(k / 1000 + 1)].state;
      for (std::size_t j = 0; j < kJoints; ++j) worst[j] = std::max(worst[j], std::abs(x.q[j] - planned.q[j]));
    }
  }
  const Perturbed told = certificate_of(trajectory).closed_loop.perturbed;
  // A hundredth of what is judged.
  for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(told.link[j], std::max(worst[j], pi / 65536), 1e-6);
}

}  // namespace
}  // namespace fjr
