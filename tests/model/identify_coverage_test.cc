// The experiments at the paper's length, and how often 95 % intervals hold the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "tests/model/virtual_lab.h"

namespace fjr {
namespace {

std::vector<Estimate> at_full_length(const Rig& rig, bool slow_speeds, const Parameters& believed) {
  std::vector<Estimate> estimates;
  for (const std::string& name : experiment_names()) {
    for (int joint = 0; joint < kJoints; ++joint) {
      estimates.push_back(
          identify(name, measure(perform(name, rig, joint, Experiments::of_paper(slow_speeds)), rig), joint, believed));
    }
  }
  return estimates;
}

TEST(FullLength, IdealLogsGiveEveryParameterWithinATenthOfAPercent) {
  std::mt19937_64 random(2);
  const Rig rig = Rig::ideal(another_arm(random));
  const Parameters believed = wrong_by_half(rig.truth, random);
  const Identified found = combine(believed, at_full_length(rig, true, believed));
  ASSERT_EQ(found.names.size(), 20U);
  for (const std::string& name : found.names) {
    const double truth = parameter(rig.truth, name);
    EXPECT_NEAR(parameter(found.robot, name), truth, 1e-3 * std::abs(truth)) << name;
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(found.damping[j], rig.truth.link.damping[j], 1e-3 * rig.truth.link.damping[j]);
  }
}

TEST(FullLength, RealInstrumentsCostLittle) {
  std::mt19937_64 random(3);
  const Rig rig = Rig::of(another_arm(random));
  const Parameters believed = wrong_by_half(rig.truth, random);
  const Identified found = combine(believed, at_full_length(rig, false, believed));
  ASSERT_EQ(found.names.size(), 19U);  // h of joint 1 is not determined
  for (const std::string& name : found.names) {
    const double truth = parameter(rig.truth, name);
    const double allowed = name.find("inertia") != std::string::npos ? 0.02 : 0.01;
    if (name.find("friction") == 0) continue;
    EXPECT_NEAR(parameter(found.robot, name), truth, allowed * truth) << name;
  }
  for (int joint = 0; joint < kJoints; ++joint) {
    const FrictionLaw truth = FrictionLaw::of(rig.truth, joint), law = FrictionLaw::of(found.robot, joint);
    const double range = 2 * truth.torque(6.0);
    for (double v = 0.004; v <= 6; v *= 1.05) EXPECT_NEAR(law.torque(v), truth.torque(v), 0.02 * range) << v;
  }
}

// Eight arms of which other ones are believed, four labs each: of 32 intervals at 95 %, 26 or fewer would hold the
// truth with a probability of 0.0046 for each parameter; the rms of 32 errors in standard errors is 1 +- 0.13.
TEST(Coverage, NinetyFivePercentIntervalsHoldTheTruth) {
  constexpr int kArms = 8, kLabs = 4;
  std::mt19937_64 random(1);
  std::map<std::string, int> held;
  std::map<std::string, double> square;  // of errors in standard errors
  const auto count = [&](const std::string& name, double error, double told) {
    held[name] += std::abs(error) <= 1.96 * told;
    square[name] += std::pow(error / told, 2) / (kArms * kLabs);
  };
  for (int arm = 0; arm < kArms; ++arm) {
    Rig rig = Rig::of(another_arm(random));
    const Parameters believed = wrong_by_half(rig.truth, random);
    std::vector<NamedRecord> records = short_experiments(rig, false);
    for (int lab = 0; lab < kLabs; ++lab) {
      rig.seed = static_cast<std::uint64_t>(1000 + kLabs * arm + lab);
      std::vector<Estimate> estimates;
      for (NamedRecord& r : records) {
        // Only here does the noise of the instruments take part in the motion.
        if (r.name == "motor_inertia") r.record = perform_motor_inertia(rig, r.joint, ConstantTorques::of(r.joint));
        estimates.push_back(identify(r.name, measure(r.record, rig), r.joint, believed));
      }
      const Identified found = combine(believed, estimates);
      for (std::size_t k = 0; k < found.names.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        count(found.names[k], parameter(found.robot, found.names[k]) - parameter(rig.truth, found.names[k]),
              std::sqrt(found.covariance(row, row)));
      }
      for (std::size_t j = 0; j < kJoints; ++j) {
        count("damping" + std::to_string(j), found.damping[j] - rig.truth.link.damping[j], found.damping_error[j]);
      }
    }
  }
  for (const auto& [name, times] : held) {
    RecordProperty(name, times);
    EXPECT_GE(times, 27) << name << ", rms " << std::sqrt(square[name]);
    EXPECT_LT(square[name], 1.3 * 1.3) << name;
  }
}

// Whoever believes another h learns the true one at creeping speeds, counts and noise of the instruments included.
TEST(Coverage, CreepingSpeedsDetermineTheKinkAtRest) {
  for (const double believed : {0.5, 1.0, 2.0}) {
    Rig rig = Rig::of(consistent_robot());
    Parameters known = rig.truth;
    known.friction.second_shape[0] *= believed;
    const Log log = measure(perform_motor_friction(rig, 0, ConstantSpeeds::of(0, true)), rig);
    const Estimate e = identify("motor_friction", log, 0, known);
    EXPECT_TRUE(e.assumed.empty());
    const double truth = rig.truth.friction.second_shape[0], h = e.at("second_shape");
    EXPECT_NEAR(h, truth, 3 * e.standard_error("second_shape"));
    EXPECT_LT(e.standard_error("second_shape"), 0.05 * std::abs(truth));  // 3 %
  }
}

}  // namespace
}  // namespace fjr
