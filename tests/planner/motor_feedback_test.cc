// The feedback that certificate and executor share, its dither, and its commands tick by tick.
#include "planner/control/motor_feedback.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "planner/certificate/perturbed.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/rollout.h"
#include "planner/certificate/tracking.h"
#include "support/exact_trajectories.h"
#include "support/linearised_arm.h"

namespace fjr {
namespace {

using std::numbers::pi;
using testing::ElementsAre;

// With ticks, counts of all encoders, and friction that falls with speed at rest. The seed is that of the instability:
// without the dither link 2 comes off by 2.5 to 3.4 counts. The swing itself takes 0.07.
TEST(Feedback, HoldsTheArmWithinATenthOfACount) {
  for (const Joints<double> q : {Joints<double>{0, 0}, {0.5, 0.3}, {1.2, -0.8}, {-2.0, 1.5}, {pi, 0}}) {
    const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
    for (const double sign : {-1.0, 1.0}) {
      State<double> beside = goal.state;
      beside.theta[1] += sign * 1e-9;
      const Joints<double> deviation = deviation_at_rest(robot(), goal, beside);
      for (const double d : deviation) EXPECT_LT(d, 0.1 * exactness_tolerance(robot())) << q[0] << ", " << q[1];
    }
  }
}

// Held for a second with what the encoders read beside the truth: the largest deviation, in counts of the link encoder.
double deviation_with(const Sample& goal, const MotorFeedback::Positions& beside) {
  Sample later = goal;
  later.time = 1;
  const Trajectory resting{{goal, later}, {}};
  TickController controller(robot(), resting);
  Rollout arm(robot(), Limits{}, Accuracy::of_predictions());
  arm.start(0, goal.state, Drive::holding(goal));
  double largest = 0;
  for (int k = 0; k < 1000; ++k) {
    MotorFeedback::Positions read{arm.state().theta, arm.state().q};
    for (std::size_t j = 0; j < kJoints; ++j) {
      read.theta[j] += beside.theta[j];
      read.q[j] += beside.q[j];
    }
    arm.hold(controller.command(k * kTick, read).torque);
    EXPECT_TRUE(arm.run((k + 1) * kTick, {}, {}, {}));
    for (std::size_t j = 0; j < kJoints; ++j) {
      largest = std::max(largest, std::abs(arm.state().q[j] - goal.state.q[j]) / exactness_tolerance(robot()));
    }
  }
  return largest;
}

// The zeros of the motors' encoders may be a count off, and those of the links' half a count: that is no more than
// where in a count the goal is.
TEST(Feedback, HoldsTheArmWithEncodersACountOff) {
  const Joints<double>& motors = robot().encoder.motor_counts;
  const double motor_1 = count_angle(motors[0]), motor_2 = count_angle(motors[1]), link = exactness_tolerance(robot());
  const Joints<double> q{1.2, -0.8};
  const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_LT(deviation_with(goal, {{sign * motor_1, 0}, {0, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, sign * motor_2}, {0, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {sign * link / 2, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {0, sign * link / 2}}), 0.5) << sign;
    // A whole one is pulled at for ever, and moves link 2, whose motor's friction yields, by what is wrong.
    EXPECT_LT(deviation_with(goal, {{0, 0}, {sign * link, 0}}), 0.5) << sign;
    EXPECT_LT(deviation_with(goal, {{0, 0}, {0, sign * link}}), 1) << sign;
  }
}

// A count off at first: it gets no worse, wherever in a count the goal is.
TEST(Feedback, HoldsTheArmFromACountOff) {
  for (double at = 0; at < 1; at += 0.125) {
    const double count = exactness_tolerance(robot());
    const Joints<double> q{0.5 + at * count, 0.3 + 2 * at * count};
    const Sample goal{0, rest_at(robot(), q), gravity_torque(robot(), q)};
    for (const Joints<double> off : {Joints<double>{0.5, -0.5}, {1, 1}, {1, -1}, {-1, 1}}) {
      const Joints<double> deviation = deviation_at_rest(robot(), goal, moved(goal.state, off));
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_LT(deviation[j], (std::abs(off[j]) + 0.1) * count) << at << " " << off[0] << ", " << off[1];
      }
    }
  }
}

// Why it is stable: the slope of joint 2's law in the mean over a swing, which is what errors of its velocity see.
TEST(Dither, MakesFrictionRiseWithSpeedInTheMean) {
  const FrictionLaw law = FrictionLaw::of(robot(), 1);
  const auto mean_slope = [&](double bands) {
    double sum = 0;
    for (int k = 0; k < 1000; ++k) sum += law.slope(bands * law.unstable_band() * std::sin(2 * pi * (k + 0.5) / 1000));
    return sum / 1000;
  };
  EXPECT_LT(mean_slope(1.4), 0);
  EXPECT_GT(mean_slope(1.6), 0);
  EXPECT_GT(mean_slope(kDitherBands), 15);
  EXPECT_NEAR(Dither(robot(), 1, kTick).amplitude(), kDitherBands * law.unstable_band(), 1e-12);
  EXPECT_EQ(Dither(robot(), 0, kTick).amplitude(), 0);
}

TEST(Dither, BeginsAfterSomeTicksOfRestAndAddsNothingInTheMean) {
  Dither dither(robot(), 1, kTick), of_joint_1(robot(), 0, kTick);
  for (int k = 0; k < kDitherAfter; ++k) EXPECT_EQ(dither.next(0), 0);
  double sum = 0, largest = 0;
  for (int k = 0; k < kDitherPeriod; ++k) {
    const double torque = dither.next(0);
    sum += torque;
    largest = std::max(largest, std::abs(torque));
    EXPECT_EQ(of_joint_1.next(0), 0);
  }
  EXPECT_NEAR(sum, 0, 1e-12);
  EXPECT_GT(largest, 0.02);  // friction at 2e-3 rad/s
  EXPECT_LT(largest, 0.05);  // a hundredth of the torque limit
  EXPECT_EQ(dither.next(0.01), 0);
  EXPECT_EQ(dither.next(0), 0);
}

// Where the plan creeps, planned torque and dither are together the friction at planned and swing velocity, in the mean
// over a swing; the mean by the midpoint rule with 1000 points, eight a tick differ from it by less than 1e-6 N m.
TEST(Dither, MakesUpForTheFrictionOfAMotorThatCreeps) {
  const FrictionLaw law = FrictionLaw::of(robot(), 1);
  const double creep = 0.7 * law.unstable_band();  // [rad/s]
  Dither dither(robot(), 1, kTick);
  for (int k = 0; k < kDitherAfter; ++k) EXPECT_EQ(dither.next(creep), 0);
  double commanded = 0, friction = 0;
  for (int k = 0; k < kDitherPeriod; ++k) commanded += (law.torque(creep) + dither.next(creep)) / kDitherPeriod;
  for (int k = 0; k < 1000; ++k) {
    friction += law.torque(creep + dither.amplitude() * std::sin(2 * pi * (k + 0.5) / 1000)) / 1000;
  }
  EXPECT_NEAR(commanded, friction, 1e-6);
  EXPECT_GT(std::abs(friction - law.torque(creep)), 1e-3);  // what would be missing
}

// Torque of joint 2 for errors of this many counts of its motor and of its link.
double feedback_at(double motor_counts, double link_counts, const Joints<double>& planned_velocity = {1, 1}) {
  const Parameters& p = robot();
  MotorFeedback feedback(p, kTick);
  const MotorFeedback::Positions planned{{0, 0}, {0, 0}},
      measured{{0, -motor_counts * count_angle(p.encoder.motor_counts[1])},
               {0, -link_counts * count_angle(p.encoder.link_counts[1])}};
  feedback.start(planned.theta, measured.theta);
  return feedback.command(planned, planned_velocity, measured, {0, 0}).feedback[1];
}

// Two rests, between which motor 2 moves for 8 ms, and the same tick by tick, from the instants at which they begin.
TEST(Dither, OfAPlanIsThatOfItsTicks) {
  Trajectory trajectory = resting({0.3, 0.2}, 0.05);
  for (std::size_t k = 20; k < 28; ++k) trajectory.samples[k].state.dtheta[1] = 0.01;
  const PlannedDither planned(robot(), trajectory);
  Dither dither(robot(), 1, kTick);
  int steps = 0;
  for (int k = 0; k < 50; ++k) {
    const double torque = dither.next(trajectory.samples[static_cast<std::size_t>(k)].state.dtheta[1]);
    steps += k >= kDitherAfter && (k < 20 || k >= 28 + kDitherAfter);
    EXPECT_EQ(torque != 0, k >= kDitherAfter && (k < 20 || k >= 28 + kDitherAfter)) << k;
    EXPECT_EQ(planned.at(k / 1000.0), (Joints<double>{0, torque})) << k;  // as a file of milliseconds has it
    for (const double share : {0.01, 0.5, 0.99}) {
      EXPECT_EQ(planned.at((k + share) * kTick), (Joints<double>{0, torque})) << k;
    }
  }
  EXPECT_EQ(planned.steps().size(), static_cast<std::size_t>(steps + 1));  // each tick of it, and the end of the first
  EXPECT_TRUE(std::is_sorted(planned.steps().begin(), planned.steps().end()));
}

TEST(Feedback, IsZeroWithinACountOfTheMotorWhereTheLinkEncoderActs) {
  const Parameters& p = robot();
  const double motor = count_angle(p.encoder.motor_counts[1]), link = count_angle(p.encoder.link_counts[1]);
  EXPECT_EQ(feedback_at(0.49, 0.49), 0);
  EXPECT_NEAR(feedback_at(2, 0), p.feedback.position_gain[1] * 2 * motor, 1e-9);
  EXPECT_NEAR(feedback_at(0, 3), 0.5 * p.spring.stiffness[1] * 2.5 * link, 1e-9);
  EXPECT_NEAR(feedback_at(0, 100), 0.5 * p.spring.stiffness[1] * 0.5 * motor, 1e-9);
  EXPECT_NEAR(feedback_at(0, -100), -feedback_at(0, 100), 1e-15);
  EXPECT_EQ(feedback_at(1.4, 0.4, {0, 0}), 0);  // at rest
  EXPECT_NEAR(feedback_at(1.4, 20, {0, 0}), feedback_at(1.4, 20), 1e-15);
  EXPECT_NEAR(feedback_at(1.6, 0.4, {0, 0}), p.feedback.position_gain[1] * 2 * motor, 1e-9);
}

// The map over one tick of the linearised arm, of the filters, and of torques that come one tick late; friction is that
// of motors in motion, B. Spectral radius below 1: stable.
double spectral_radius_of_a_tick(const Parameters& p, const Joints<double>& q) {
  constexpr int kLast = kStates, kVelocity = kLast + 2, kTorque = kVelocity + 2, kSize = kTorque + 2;
  Eigen::MatrixXd continuous = Eigen::MatrixXd::Zero(kStates + 2, kStates + 2);
  continuous.topLeftCorner(kStates, kStates) = linearised_arm(q);
  for (int j = 0; j < kJoints; ++j) continuous(6 + j, kStates + j) = 1 / p.motor.inertia[static_cast<std::size_t>(j)];
  const Eigen::MatrixXd over_a_tick = (continuous * kTick).exp();
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(kSize, kSize);
  map.topLeftCorner(kStates, kStates) = over_a_tick.topLeftCorner(kStates, kStates);
  map.block(0, kTorque, kStates, 2) = over_a_tick.topRightCorner(kStates, 2);
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double keep = std::exp(-2 * pi * p.feedback.velocity_filter[i] * kTick);
    map(kLast + j, 4 + j) = 1;
    map(kVelocity + j, kVelocity + j) = keep;
    map(kVelocity + j, 4 + j) = (1 - keep) / kTick;
    map(kVelocity + j, kLast + j) = -(1 - keep) / kTick;
    map.row(kTorque + j) = -p.feedback.velocity_gain[i] * map.row(kVelocity + j);
    map(kTorque + j, 4 + j) -= p.feedback.position_gain[i];
  }
  return map.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Feedback, OfMotorTwoIsStableUpToTenTimesItsGainsAndATickLate) {
  const auto radius = [](double factor) {
    Parameters p = robot();
    p.feedback.position_gain[1] *= factor;
    p.feedback.velocity_gain[1] *= factor;
    double largest = 0;
    for (const Joints<double> q : {Joints<double>{0, 0}, {1.2, -0.8}, {0.3, 1.57}, {0, 2.6}}) {
      largest = std::max(largest, spectral_radius_of_a_tick(p, q));
    }
    return largest;
  };
  EXPECT_LT(radius(1), 0.9996);  // the slowest is link 1's swing
  EXPECT_LT(radius(10), 1);
  EXPECT_GT(radius(40), 1);
}

// ---- the executor's law ----

TEST(Tracking, CommandsThePlannedMeanWhenTheArmIsWhereItShouldBe) {
  Parameters fine = robot();
  fine.encoder.motor_counts = {1e9, 1e9};
  const Trajectory& plan = reference_trajectory();
  TickController controller(fine, plan);
  Interpolator at(plan);
  for (int k = 0; k < 430; ++k) {
    const double t = k * kTick;
    const TickController::Command command = controller.command(t, {at.at(t).state.theta, at.at(t).state.q});
    const Joints<double> mean = at.mean_torque(t, t + kTick);
    for (std::size_t j = 0; j < kJoints; ++j) EXPECT_NEAR(command.torque[j], mean[j], 1e-4);
    EXPECT_FALSE(command.saturated);
  }
}

TEST(Tracking, IsLimitedByTheEncoderAndNotByTheFilter) {
  const Tracking t = certificate_of(reference_trajectory()).tracking;
  // Half a count of the motor encoders, 0.79e-3 and 1.57e-3 rad: what feedback does not see.
  EXPECT_LT(t.link_error[0], 0.79e-3);
  EXPECT_LT(t.link_error[1], 1.57e-3);
  EXPECT_GT(t.link_error[1], 1e-6);
  EXPECT_LE(t.link_error_rms[1], t.link_error[1]);
  // A count (1.57e-3 and 3.14e-3 rad) through the gains and the filter: about 0.6 and 0.3 N m.
  EXPECT_LT(t.feedback_torque[0], 1.0);
  EXPECT_LT(t.feedback_torque[1], 0.6);
  EXPECT_FALSE(t.saturated);
}

TEST(Tracking, ClampsAtTheDrivesPeakAndSaysSo) {
  TickController controller(robot(), reference_trajectory());
  const TickController::Command command = controller.command(0, {{3, -3}, {0, 0}});
  EXPECT_THAT(command.torque, ElementsAre(-14.4, 6));
  EXPECT_TRUE(command.saturated);
}

}  // namespace
}  // namespace fjr
