// Whether an arm is told from the one known: false alarms, causes, and since when.
#include "planner/identify/drift.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "model/uncertainty.h"
#include "tests/identify/executions.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd normal_numbers(Index n, std::mt19937& random) {
  std::normal_distribution<double> normal;
  VectorXd v(n);
  for (double& number : v) number = normal(random);
  return v;
}

// A motion as its theory has it: the test takes neighbouring readings for so much alike that scores have four times the
// variance of independent ones. z: how far the arm is off.
DriftTest::Look drawn_motion(const VectorXd& z, std::mt19937& random) {
  const Index n = z.size();
  MatrixXd root(n, n);
  for (double& entry : root.reshaped()) entry = 30 * normal_numbers(1, random)[0];
  MotionInformation told;
  told.matrix = root * root.transpose();
  told.score = told.matrix * z + 2 * root * normal_numbers(n, random);
  told.chi_square = 1;
  return {told, VectorXd::Zero(n)};
}

Parameters with_errors(double fraction) {
  Parameters p = robot();
  Uncertainty u;
  u.names = usually_told(p);
  u.names.pop_back();  // the payload's mass
  const auto n = static_cast<Index>(u.names.size());
  u.covariance = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    u.covariance(i, i) = std::pow(fraction * *parameter_named(p, u.names[static_cast<std::size_t>(i)]), 2);
  }
  p.uncertainty = std::make_shared<const Uncertainty>(u);
  return p;
}

// The evidence less the number of motions is a martingale, so that after m motions an alarm has been given with a
// probability of at most m / kMotionsPerFalseAlarm (Doob): in 8 of 200 series of 40 motions in the mean, and in more
// than 20 with a probability below 1e-4.
int alarms_in_series(const Parameters& known, double off, std::mt19937& random) {
  int alarms = 0;
  for (int series = 0; series < 200; ++series) {
    DriftTest test(known);
    VectorXd z = VectorXd::Zero(test.parameters().factor.rows());
    z.head(12) = off * normal_numbers(12, random);
    bool alarm = false;
    for (int motion = 0; motion < 40 && !alarm; ++motion) {
      test.add(drawn_motion(z, random));
      alarm = test.drifts();
    }
    alarms += alarm ? 1 : 0;
  }
  return alarms;
}

TEST(Drift, FalseAlarmsAreAsRareAsPromised) {
  std::mt19937 random(5);
  EXPECT_LE(alarms_in_series(robot(), 0, random), 20);
  const Parameters uncertain = with_errors(0.003);  // z = 0.3
  EXPECT_LE(alarms_in_series(uncertain, 0.3, random), 20);
  EXPECT_EQ(alarms_in_series(robot(), 0.3, random), 200);  // the same arms, where robot.yaml claims to be exact
}

TEST(Drift, TellsSinceWhen) {
  std::mt19937 random(6);
  int right = 0;
  for (int series = 0; series < 20; ++series) {
    DriftTest test(robot());
    VectorXd z = VectorXd::Zero(test.parameters().factor.rows());
    for (int motion = 0; motion < 12; ++motion) {
      if (motion == 7) z[4] = 0.5;
      test.add(drawn_motion(z, random));
    }
    ASSERT_TRUE(test.drifts());
    const auto cause = test.cause();
    EXPECT_EQ(cause->parameter, test.parameters().names[4]);
    right += cause->since == 7 ? 1 : 0;
    EXPECT_NEAR(cause->change, 0.005 * cause->known, 4 * cause->error);
  }
  EXPECT_GE(right, 18);  // measured: 20
}

DriftTest::Look look_at(const DriftTest& test, const ExecutedMotion& motion) {
  const auto look = test.look_at(motion, kTwoThreads);
  if (!look) throw std::runtime_error("the motion tells nothing");
  return *look;
}

const std::vector<Move> kShort{{{0, 0}, {0.9, -1.1}, 0.5}, {{0.9, -1.1}, {-0.3, 0.2}, 0.6}};

// Viscous friction grows by half a per cent between the second motion and the third.
TEST(Drift, IsNoticedLongBeforeTolerancesAreLeft) {
  Parameters truth = robot();
  DriftTest test(robot());
  for (const ExecutedMotion& motion : executed(robot(), {.truth = truth}, kShort).motions) {
    test.add(look_at(test, motion));
  }
  EXPECT_FALSE(test.drifts());
  truth.friction.viscous[0] *= 1.005;
  const Executions after = executed(robot(), {.truth = truth}, {kShort.front()});
  test.add(look_at(test, after.motions.front()));
  ASSERT_TRUE(test.drifts());
  const auto cause = test.cause();
  EXPECT_EQ(cause->parameter, "friction.viscous[0]");
  EXPECT_GT(cause->share, 0.9);
  EXPECT_EQ(cause->since, 2U);
  EXPECT_NEAR(cause->change, 0.005 * robot().friction.viscous[0], 4 * cause->error);
  EXPECT_LT(after.results.front().link_error[0], ExecutorConfig{}.tolerances.path[0] / 10);
}

// 2 % change the slopes themselves: motions are held against what is expected of the arm after those before.
TEST(Drift, AnArmWithinItsStandardErrorsDoesNotDrift) {
  const Parameters known = with_errors(0.02);
  std::mt19937 random(8);
  const Uncertainty u = uncertainty_of(known);
  const Parameters truth = changed(known, u.names, u.factor() * normal_numbers(u.factor().cols(), random));
  DriftTest uncertain(known), exact(robot());
  for (const ExecutedMotion& motion : executed(robot(), {.truth = truth}, kShort).motions) {
    uncertain.add(look_at(uncertain, motion));
    exact.add(look_at(exact, motion));
  }
  EXPECT_FALSE(uncertain.drifts()) << uncertain.evidence();
  EXPECT_TRUE(exact.drifts());
}

// An executor that ends waits for what is being looked at, in a thread of the least priority: no longer than one
// rollout.
TEST(Drift, WhatIsStoppedEndsWithinARollout) {
  const Executions one = executed(robot(), {.truth = robot()}, {kShort.front()});
  const DriftTest test(robot());
  int asked = 0, after = 0;
  const auto stopped = [&] {
    constexpr int kWanted = 20;
    ++asked;
    if (asked > kWanted) ++after;
    return asked > kWanted;
  };
  EXPECT_FALSE(test.look_at(one.motions.front(), one_after_another, stopped));
  EXPECT_GE(after, 1);
  EXPECT_LE(after, 10);  // questions, not rollouts: a fit of eight unknowns would ask 17 times for one step alone
}

}  // namespace
}  // namespace fjr
