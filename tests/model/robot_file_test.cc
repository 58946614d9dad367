// Robot files that are written from what was identified.
#include "model/identify/robot_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "model/identify/arm.h"
#include "tests/model/noisy_logs.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A folder of this test's own, gone with it.
class RobotFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& text) const {
    std::ofstream(folder_ / "robot.yaml") << text;
    return folder_ / "robot.yaml";
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("fjr_robot_" + std::to_string(getpid()));
};

TEST_F(RobotFile, IsCompleteAndLoads) {
  const Rig rig = Rig::of(load_parameters(kRobot));
  std::vector<Estimate> estimates;
  for (const NamedRecord& r : short_experiments(rig, false)) {
    Log log = measure(r.record, rig);
    log.source = r.name + ".csv";
    log.hash = "0123abcd";
    estimates.push_back(identify(r.name, log, r.joint, rig.truth));
  }
  const Identified found = combine(load_parameters(kRobot), estimates);
  const std::string text = format_robot(found, kRobot, false);
  EXPECT_EQ(robot_hash(load_parameters(write(text))), robot_hash(found.robot));
  EXPECT_THAT(text, HasSubstr("identified: gravity.csv sha256 0123abcd"));
  EXPECT_THAT(text, HasSubstr("identified but not used: joint 1: 0.25"));
  EXPECT_EQ(load_parameters(write(text)).link.damping, (Joints<double>{0, 0}));
  const Parameters damped = load_parameters(write(format_robot(found, kRobot, true)));
  EXPECT_NEAR(damped.link.damping[0], 0.2516, 1e-3);
  EXPECT_NEAR(damped.link.damping[1], 0.01, 1e-4);
}

TEST_F(RobotFile, TakesTheBoundWhereTheKnownShapeContradictsTheLog) {
  Parameters known = load_parameters(kRobot);
  known.friction.second_shape[0] = -20;
  const std::vector<Estimate> one = {identify("motor_friction", noisy_log("motor_friction", 0), 0, known)};
  EXPECT_THAT(warnings_of(one[0]), HasSubstr("is this bound"));
  const Identified found = combine(known, one);
  EXPECT_LT(found.robot.friction.second_shape[0], -50);
  EXPECT_THAT(found.names, testing::Not(testing::Contains("friction.second_shape[0]")));
  const std::string text = format_robot(found, kRobot, false);
  EXPECT_EQ(load_parameters(write(text)).friction.second_shape, found.robot.friction.second_shape);
  EXPECT_THAT(text, HasSubstr("joint 1 only bounded by its log: the bound"));
}

TEST_F(RobotFile, KeepsWhatNoLogTells) {
  const std::vector<Estimate> one = {identify_quietly("stiffness", noisy_log("stiffness", 0), 0)};
  const Identified found = combine(load_parameters(kRobot), one);
  EXPECT_EQ(found.names, std::vector<std::string>{"spring.stiffness[0]"});
  const Parameters p = load_parameters(write(format_robot(found, kRobot, false)));
  EXPECT_EQ(p.spring.stiffness[1], 17.75);
  EXPECT_EQ(p.link.inertia[0], 0.0915);
  EXPECT_NE(p.spring.stiffness[0], 20.48);
}

}  // namespace
}  // namespace fjr
