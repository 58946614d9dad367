// The experiments at the paper's length, and how often 95 % intervals hold the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/model/virtual_lab.h"

namespace fjr {
namespace {

std::vector<Estimate> at_full_length(const Rig& rig, bool slow_speeds) {
  std::vector<Estimate> estimates;
  for (const char* name : kExperiments) {
    for (int joint = 0; joint < kJoints; ++joint) {
      estimates.push_back(identify(name, measure(perform(name, rig, joint, Experiments::of_paper(slow_speeds)), rig),
                                   joint, rig.truth));
    }
  }
  return estimates;
}

TEST(FullLength, IdealLogsGiveEveryParameterWithinATenthOfAPercent) {
  const Rig rig = Rig::ideal(load_parameters(FJR_SOURCE_DIR "/config/robot.yaml"));
  const std::vector<Estimate> estimates = at_full_length(rig, true);
  const Identified found = combine(rig.truth, estimates);
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
  const Rig rig = Rig::of(consistent_robot());
  const std::vector<Estimate> estimates = at_full_length(rig, false);
  const Identified found = combine(rig.truth, estimates);
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

TEST(Coverage, NinetyFivePercentIntervalsHoldTheTruth) {
  constexpr int kRepetitions = 100;
  Rig rig = Rig::of(consistent_robot());
  std::vector<NamedRecord> records = short_experiments(rig, false);
  std::map<std::string, int> held;
  for (int i = 0; i < kRepetitions; ++i) {
    rig.seed = static_cast<std::uint64_t>(1000 + i);
    std::vector<Estimate> estimates;
    for (NamedRecord& r : records) {
      // Only here does the noise of the instruments take part in the motion.
      if (r.name == "motor_inertia") r.record = perform_motor_inertia(rig, r.joint, ConstantTorques::of(r.joint));
      estimates.push_back(identify(r.name, measure(r.record, rig), r.joint, rig.truth));
    }
    const Identified found = combine(rig.truth, estimates);
    for (std::size_t k = 0; k < found.names.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double error = parameter(found.robot, found.names[k]) - parameter(rig.truth, found.names[k]);
      held[found.names[k]] += std::abs(error) <= 1.96 * std::sqrt(found.covariance(row, row));
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      held["damping" + std::to_string(j)] +=
          std::abs(found.damping[j] - rig.truth.link.damping[j]) <= 1.96 * found.damping_error[j];
    }
  }
  for (const auto& [name, count] : held) {
    RecordProperty(name, count);
    EXPECT_GE(count, 90) << name;
  }
}

}  // namespace
}  // namespace fjr
