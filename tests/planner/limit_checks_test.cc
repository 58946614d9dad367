// What limits reach between the published rows, and what may be exceeded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "planner/certificate/limits.h"
#include "planner/certificate/request_check.h"
#include "planner/certificate/thresholds.h"
#include "support/exact_trajectories.h"

namespace fjr {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Sample row_at(double time, double q, double dq, double dtheta) {
  Sample row;
  row.time = time;
  row.state.q = {q, 0};
  row.state.dq = {dq, 0};
  row.state.theta = {q, 0};
  row.state.dtheta = {dtheta, 0};
  return row;
}

LimitCheck named(const std::vector<LimitCheck>& checks, const std::string& name, int joint) {
  for (const LimitCheck& check : checks) {
    if (check.name == name && check.joint == joint) return check;
  }
  ADD_FAILURE() << "no check of " << name;
  return {};
}

TEST(LimitChecks, FindExtremesBetweenTheRowsExactly) {
  // q: 0 -> 0 in 1 s with slopes 4 and -4: q = 4 s (1 - s), 1 at the middle. theta: slopes 0 and 0 over a step of 0.4:
  // velocity 6 * 0.4 s (1 - s), 0.6 at the middle; both rows' columns say 0.
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 4, 0), row_at(1, 0, -4, 0)};
  trajectory.samples[1].state.theta = {0.4, 0};
  Limits limits;
  limits.link_position = {0.99, kNoLimit};
  limits.motor_velocity = {0.6, kNoLimit};
  limits.spring_deflection = {2, kNoLimit};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 3u);
  EXPECT_NEAR(named(checks, "link_position", 1).reached, 1, 1e-12);
  EXPECT_NEAR(named(checks, "link_position", 1).time, 0.5, 1e-12);
  EXPECT_FALSE(named(checks, "link_position", 1).passed);
  EXPECT_THAT(violation(named(checks, "link_position", 1)),
              HasSubstr("link_position of joint 1 reaches 1 at 0.500000 s"));
  EXPECT_NEAR(named(checks, "motor_velocity", 1).reached, 0.6, 1e-12);
  EXPECT_TRUE(named(checks, "motor_velocity", 1).passed);  // on the limit, to rounding
  double sampled = 0;                                      // theta - q = 0.4 (3 s^2 - 2 s^3) - 4 s (1 - s)
  for (int i = 0; i <= 100000; ++i) {
    const double s = i * 1e-5;
    sampled = std::max(sampled, std::abs(0.4 * s * s * (3 - 2 * s) - 4 * s * (1 - s)));
  }
  EXPECT_NEAR(named(checks, "spring_deflection", 1).reached, sampled, 1e-8);
}

TEST(LimitChecks, AllowAMillionthAndNoMore) {
  Limits limits;
  limits.torque = {5, kNoLimit};
  for (const auto& [torque, passes] : {std::pair{5 * (1 + 0.9e-6), true}, {5 * (1 + 1.1e-6), false}, {-5.1, false}}) {
    Trajectory trajectory = resting({0, 0}, 0.01);
    trajectory.samples[4].torque[0] = torque;
    EXPECT_EQ(check_limits(robot(), limits, trajectory, {})[0].passed, passes) << torque;
  }
}

TEST(LimitChecks, ALimitOnlyTheRolloutExceedsIsRefused) {
  Trajectory trajectory = resting({0, 0}, 0.01);
  Limits limits;
  limits.motor_velocity = {6, 8};
  Comparison rollout;
  rollout.peaks.motor_velocity = {6.005, 8.009};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, rollout);
  EXPECT_TRUE(checks[0].passed);   // 0.1 % of 6 is 0.006
  EXPECT_FALSE(checks[1].passed);  // 0.1 % of 8 is 0.008
  EXPECT_THAT(violation(checks[1]), HasSubstr("closed-loop rollout"));
  Comparison brief;
  brief.events = {{0.005, &MotorVelocity::info, 1}};
  EXPECT_FALSE(check_limits(robot(), limits, trajectory, brief)[0].passed);
}

TEST(LimitChecks, TorqueRateIsThatOfTheCompensatedTorque) {
  // u = 3 t + 1 for joint 1 while its motor reverses: tau jumps by the friction, in a pair of rows.
  const FrictionLaw law = FrictionLaw::of(robot(), 0);
  Trajectory trajectory;
  for (const double t : {0.0, 1e-3, 2e-3, 2.4e-3 - 5e-7, 2.4e-3 + 5e-7, 3e-3, 4e-3}) {
    Sample row;
    row.time = t;
    row.state.dtheta[0] = 20 * (t - 2.4e-3);
    row.torque[0] = 3 * t + 1 + law.nonlinear(row.state.dtheta[0]);
    trajectory.samples.push_back(row);
  }
  Limits limits;
  limits.torque_rate = {3, kNoLimit};
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_NEAR(checks[0].reached, 3, 1e-9);
  EXPECT_TRUE(checks[0].passed);
  trajectory.samples[5].torque[0] += 1e-3;
  EXPECT_NEAR(check_limits(robot(), limits, trajectory, {})[0].reached, 3 + 1e-3 / (0.6e-3 - 5e-7), 1e-6);
}

TEST(TaskChecks, TheFirstRowIsOneOfThem) {
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 2, 0), row_at(0.1, 0.2, 2, 0)};  // away from hanging straight down
  Task task;
  task.box = TipBox{{0, -1}, {1, 1}};
  Certificate certificate;
  check_against_task(robot(), task, {0.1}, trajectory, certificate);
  ASSERT_FALSE(certificate.task.empty());
  EXPECT_EQ(certificate.task[0].time, 0);
  EXPECT_NEAR(certificate.task[0].clearance, 0, 1e-12);
}

// The stretched arm passes a point between two instants that are 0.25 ms apart: 0.2 mm before it and 0.3 mm behind it.
TEST(TaskChecks, WhatALinkPassesThroughBetweenInstantsIsSeen) {
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 4, 0), row_at(0.1, 0.4, 4, 0)};
  Parameters thin = robot();
  thin.link.radius = {1e-5, 1e-5};
  const double passed = 4 * (0.05 + 1e-4);
  Task task;
  task.obstacles.discs = {Disc{{0.5 * std::sin(passed), -0.5 * std::cos(passed)}, 0, 0}};
  Certificate certificate;
  certificate.certified = true;
  check_against_task(thin, task, {0.1}, trajectory, certificate);
  EXPECT_FALSE(certificate.certified);
  const auto& worst = *std::min_element(certificate.task.begin(), certificate.task.end(),
                                        [](const auto& a, const auto& b) { return a.clearance < b.clearance; });
  EXPECT_EQ(worst.link, 2);
  EXPECT_NEAR(worst.clearance, -1e-5, 1e-8);  // 1e-9 s at 2 m/s
  EXPECT_NEAR(worst.time, 0.0501, 1e-8);
}

// A corner that does not bend is passed at full speed, and each segment keeps to its own line. 0.1 ms from the corner
// there is no instant: the rows of one segment must not be held against the other, which would miss by 1.5e-4 rad.
TEST(TaskChecks, ACornerThatDoesNotBendIsPassedAtFullSpeed) {
  for (const double passed : {0.05, 0.0501}) {
    Trajectory trajectory;
    trajectory.samples = {row_at(0, 0, 3, 0), row_at(0.1, 0.3, 3, 0)};
    Task task;
    task.path = JointPath{{{0, 0}, {3 * passed, 0}, {0.3, 0}}, 1e-4};
    Certificate certificate;
    certificate.certified = true;
    check_against_task(robot(), task, {passed, 0.1}, trajectory, certificate);
    EXPECT_TRUE(certificate.certified) << certificate.failures.front();
    EXPECT_GT(certificate.task.at(0).clearance, 1e-5) << passed;
  }
}

// With hardly any gain the feedback does not tell whether velocities are true.
TEST(Thresholds, ASmallGainAllowsNoLargeVelocityError) {
  Parameters soft = robot();
  soft.feedback.velocity_gain = {1e-3, 0};
  EXPECT_EQ(motor_velocity_tolerance(soft)[0], 0.01);
  EXPECT_EQ(motor_velocity_tolerance(soft)[1], 0.01);
}

// A row that is far from all others makes no rate at the others the mean of a long time.
TEST(LimitChecks, ALongRestAfterwardsHidesNoTorqueRate) {
  Trajectory trajectory;
  for (int k = 0; k <= 20; ++k) {
    Sample row;
    row.time = 1e-3 * k;
    row.torque[0] = k < 10 ? 0 : 0.5;  // 500 N m/s for a millisecond
    trajectory.samples.push_back(row);
  }
  Limits limits;
  limits.torque_rate = {60, kNoLimit};
  const double honest = check_limits(robot(), limits, trajectory, {})[0].reached;
  EXPECT_NEAR(honest, 500, 1e-9);
  for (const double longest : {0.004, 1.0, 100.0}) {
    Trajectory padded = trajectory;
    padded.samples.push_back(trajectory.samples.back());
    padded.samples.back().time += longest;
    EXPECT_EQ(check_limits(robot(), limits, padded, {})[0].reached, honest) << longest;
  }
}

// Rows that are far apart make no step between two others the mean of a long time.
TEST(LimitChecks, AStepBetweenRowsThatAreFarApartHidesNoTorqueRate) {
  for (const double apart : {5e-4, 2e-3, 1e-2, 1.0}) {
    Trajectory trajectory;
    for (const auto& [time, torque] : {std::pair{0.0, 0.0}, {apart, 0.0}, {apart + 1e-6, 0.3}, {2 * apart, 0.3}}) {
      Sample row;
      row.time = time;
      row.torque[0] = torque;
      trajectory.samples.push_back(row);
    }
    Limits limits;
    limits.torque_rate = {1000, kNoLimit};
    EXPECT_NEAR(check_limits(robot(), limits, trajectory, {})[0].reached, 0.3 / 0.5e-3, 1e-6) << apart;
  }
}

// A torque that swings with the period over which a rate is taken is not constant.
TEST(LimitChecks, ASwingBetweenRowsThatAreFarApartHidesNoTorqueRate) {
  struct Swing {
    double period, apart;  // [s]
  };
  // The last one is the same in rows that are 0.51 and 1.02 ms apart, the nearest beyond 0.5 and 1 ms.
  for (const auto& [period, apart] : {Swing{0.5e-3, 5e-5}, {1e-3, 5e-5}, {2.5e-3, 5e-5}, {0.51e-3, 1.7e-4}}) {
    Trajectory trajectory;
    trajectory.samples.emplace_back();
    for (int burst = 0; burst < 3; ++burst) {
      const double begin = trajectory.samples.back().time + 5e-3;
      for (double since = 0; since < 5e-3; since += apart) {
        Sample row;
        row.time = begin + since;
        row.torque[0] = 1.5 * std::sin(2 * std::numbers::pi * since / period);
        trajectory.samples.push_back(row);
      }
    }
    Limits limits;
    limits.torque_rate = {400, kNoLimit};
    // Within 1 ms, a sine of amplitude 1.5 N m sampled three times a period or more changes by more than 1 N m.
    EXPECT_GT(check_limits(robot(), limits, trajectory, {})[0].reached, 1000) << period;
  }
}

TEST(LimitChecks, TipSpeedIsThatOfBothLinks) {
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 2, 0), row_at(0.1, 0.2, 2, 0)};
  Limits limits;
  limits.tip_speed = 1.2;
  const std::vector<LimitCheck> checks = check_limits(robot(), limits, trajectory, {});
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].joint, 0);
  EXPECT_NEAR(checks[0].reached, 2 * (0.345 + 0.305), 1e-9);  // stretched out, turning about joint 1
  EXPECT_FALSE(checks[0].passed);
}

// Between rows that are as close as the instants the cubic is faster than both: 2.1 rad/s in the mean, 2.15 in the
// middle.
TEST(LimitChecks, TipSpeedIsLargestBetweenRows) {
  Trajectory trajectory;
  trajectory.samples = {row_at(0, 0, 2, 0), row_at(0.25e-3, 2.1 * 0.25e-3, 2, 0)};
  Limits limits;
  limits.tip_speed = 1.35;
  EXPECT_NEAR(check_limits(robot(), limits, trajectory, {})[0].reached, 2.15 * (0.345 + 0.305), 1e-9);
}

}  // namespace
}  // namespace fjr
