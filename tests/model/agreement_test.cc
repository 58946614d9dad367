// What experiments, and several logs of one experiment, say of each other.
#include "model/identify/agreement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "model/identify/arm.h"
#include "model/identify/charts.h"
#include "model/identify/repeated.h"
#include "tests/model/noisy_logs.h"

namespace fjr {
namespace {

using testing::HasSubstr;

// ---- what experiments say of each other ----

std::vector<Estimate> motor_estimates(const Log& friction, const Log& inertia) {
  return {identify_quietly("motor_friction", friction, 0), identify_quietly("motor_inertia", inertia, 0)};
}

TEST(Agreement, TwoExperimentsTellTheSameViscousFriction) {
  const std::vector<Estimate> estimates =
      motor_estimates(noisy_log("motor_friction", 0), noisy_log("motor_inertia", 0));
  const std::vector<Agreement> found = agreements(estimates);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parameter, "viscous, joint 1");
  EXPECT_LT(found[0].standard_errors_apart(), kDoubtfulApart);
  for (const Change& change : changes(load_parameters(kRobot), combine(load_parameters(kRobot), estimates))) {
    EXPECT_FALSE(change.is_large()) << change.sentence();
  }
}

TEST(Agreement, ADoubledTorqueContradictsTheOtherExperiment) {
  const std::vector<Estimate> estimates =
      motor_estimates(noisy_log("motor_friction", 0), scaled(noisy_log("motor_inertia", 0), "u1_plan", 2));
  const std::vector<Agreement> found = agreements(estimates);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].standard_errors_apart(), 10 * kContradictoryApart);
  EXPECT_THAT(found[0].sentence(), HasSubstr("viscous, joint 1: motor_friction says 0.4"));
  EXPECT_THAT(found[0].sentence(), HasSubstr("motor_inertia says 0.99"));
}

// What no other experiment contradicts is told by the robot known before.
TEST(Agreement, AColumnInErrorIsALargeChange) {
  const auto large_changes = [](const std::string& name, const Log& log) {
    const Parameters known = load_parameters(kRobot);
    const std::vector<Estimate> one = {identify_quietly(name, log, 0)};
    std::string all;
    for (const Change& change : changes(known, combine(known, one))) {
      if (change.is_large()) all += change.sentence() + "\n";
    }
    return all;
  };
  EXPECT_EQ(large_changes("stiffness", noisy_log("stiffness", 0)), "");
  EXPECT_THAT(large_changes("stiffness", scaled(noisy_log("stiffness", 0), "tau1", 5)),
              HasSubstr("spring.stiffness[0] is 10"));
  EXPECT_THAT(large_changes("stiffness", scaled(noisy_log("stiffness", 0), "theta1", 0.5)),
              HasSubstr("spring.stiffness[0] is 4"));
  EXPECT_THAT(large_changes("gravity", scaled(noisy_log("gravity", 0), "tau1", 5)),
              HasSubstr("link.gravity_torque[0]"));
  EXPECT_THAT(large_changes("motor_friction", scaled(noisy_log("motor_friction", 0), "tau1", 5)),
              HasSubstr("friction.amplitude[0]"));
  EXPECT_THAT(large_changes("link_inertia", scaled(noisy_log("link_inertia", 0), "time", 1.5)),
              HasSubstr("link.inertia[0]"));
  EXPECT_THAT(large_changes("motor_inertia", scaled(noisy_log("motor_inertia", 0), "u1_plan", 1.5)),
              HasSubstr("motor.inertia[0]"));
}

// ---- several logs of one experiment ----

Log stiffness_log(std::uint64_t seed) {
  Log log = noisy_log("stiffness", 0, seed);
  log.source = "stiffness_" + std::to_string(seed) + ".csv";
  return log;
}

TEST(Repeated, LogsOfOneExperimentAreComparedAndCombinedByTheirWeights) {
  const std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                                     identify_quietly("stiffness", stiffness_log(2), 0)};
  const std::vector<Agreement> found = agreements(two);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(found[0].standard_errors_apart(), kDoubtfulApart);
  EXPECT_EQ(found[0].first, "stiffness (stiffness_1.csv)");
  EXPECT_EQ(found[0].second, "stiffness (stiffness_2.csv)");
  const Identified both = combine(load_parameters(kRobot), two);
  EXPECT_EQ(both.names, std::vector<std::string>{"spring.stiffness[0]"});
  EXPECT_EQ(both.from.at("spring.stiffness[0]").size(), 2U);
  const double a = 1 / two[0].covariance(0, 0), b = 1 / two[1].covariance(0, 0);
  const double mean = (a * two[0].value[0] + b * two[1].value[0]) / (a + b);
  const double chi_square = std::pow(two[0].value[0] - two[1].value[0], 2) / (1 / a + 1 / b);
  EXPECT_NEAR(both.robot.spring.stiffness[0], mean, 1e-12 * mean);
  EXPECT_NEAR(both.covariance(0, 0), std::max(chi_square, 1.0) / (a + b), 1e-9 / (a + b));
}

// Two that contradict each other are no more certain together than half of what they differ by.
TEST(Repeated, LogsThatContradictEachOtherAreSaidAndDoubted) {
  const std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                                     identify_quietly("stiffness", scaled(stiffness_log(2), "tau1", 1.2), 0)};
  const std::vector<Agreement> found = agreements(two);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].standard_errors_apart(), kContradictoryApart);
  const double apart = std::abs(two[0].value[0] - two[1].value[0]);
  EXPECT_GT(std::sqrt(combine(load_parameters(kRobot), two).covariance(0, 0)), 0.45 * apart);
}

TEST(Repeated, ALogWithCreepingSpeedsAddsWhatAnotherLeavesOpen) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  const Log slow = measure(perform_motor_friction(rig, 0, ConstantSpeeds::of(0, true)), rig);
  const std::vector<Estimate> two = {identify_quietly("motor_friction", noisy_log("motor_friction", 0), 0),
                                     identify_misled("motor_friction", slow, 0)};
  ASSERT_FALSE(two[0].assumed.empty());
  ASSERT_TRUE(two[1].assumed.empty());
  const Estimate both = combine_repeated(two).front().estimate;
  EXPECT_TRUE(both.assumed.empty());
  // Either log has charts of its own, and what they say together has none.
  EXPECT_FALSE(charts_of(two[0]).empty());
  EXPECT_TRUE(charts_of(both).empty());
  EXPECT_NEAR(both.at("second_shape"), -6539.2, 4 * both.standard_error("second_shape"));
  for (const char* name : {"viscous", "amplitude", "width"}) {
    EXPECT_LE(both.standard_error(name), 1.0001 * two[0].standard_error(name)) << name;
    EXPECT_LE(both.standard_error(name), 1.0001 * two[1].standard_error(name)) << name;
  }
}

TEST(Repeated, TheSameLogTwiceIsRefused) {
  Log log = stiffness_log(1);
  log.hash = "0123abcd";
  const std::vector<Estimate> same = {identify_quietly("stiffness", log, 0), identify_quietly("stiffness", log, 0)};
  EXPECT_THROW(combine_repeated(same), InputError);
}

TEST(Repeated, WhatIsNoNumberAgreesWithNothing) {
  std::vector<Estimate> two = {identify_quietly("stiffness", stiffness_log(1), 0),
                               identify_quietly("stiffness", stiffness_log(2), 0)};
  two[1].covariance(0, 0) = NAN;
  EXPECT_GT(agreements(two).front().standard_errors_apart(), kContradictoryApart);
  EXPECT_THROW(combine_repeated(two), InputError);
  two[1].covariance(0, 0) = 0;
  EXPECT_THROW(combine_repeated(two), InputError);
  EXPECT_EQ((Agreement{"B", "", "a", "b", 0.5, 0, 0.5, 0}.standard_errors_apart()), 0);
}

}  // namespace
}  // namespace fjr
