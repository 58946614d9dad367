// Arms whose range is not symmetric and whose plane of motion stands otherwise: physics knows no zero of q1. An arm
// that is turned about joint 1 with everything that pulls at it and bounds it has the same motions, turned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "model/parameters.h"
#include "planner/plan.h"
#include "planner/request/request.h"

namespace fjr {
namespace {

const Parameters& shipped() {
  static const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return robot;
}

constexpr double kTurned = 0.7;  // [rad]

// With joint 1 in [-0.6, 1.2] about `turned`.
Parameters turned(double by) {
  Parameters p = shipped();
  p.mounting.down = by;
  p.limits.link_position[0] = 0.9;
  p.limits.link_middle[0] = 0.3 + by;
  return p;
}

Plan planned(const std::string& request, const Parameters& robot) {
  return plan(parse_request(request, "request.yaml", robot), {});
}

std::string from_to(double from, double to, const std::string& more) {
  return "{start: {q: [" + std::to_string(from) + ", 0.2]}, goal: {q: [" + std::to_string(to) + ", -0.8]}" + more + "}";
}

void expect_the_same_motion(const std::string& more) {
  const Plan upright = planned(from_to(-0.6, 1.2, more), turned(0));
  const Plan other = planned(from_to(-0.6 + kTurned, 1.2 + kTurned, more), turned(kTurned));
  ASSERT_EQ(upright.status, PlanStatus::kCertified) << upright.reason;
  ASSERT_EQ(other.status, PlanStatus::kCertified) << other.reason;
  // Two searches of the same minimum, with other roundings: minimum-time problems spread by 0.3 % over starts.
  EXPECT_NEAR(other.duration, upright.duration, 3e-3 * upright.duration);
  EXPECT_NEAR(other.objective, upright.objective, 3e-3 * upright.objective);
  for (const Plan* p : {&upright, &other}) {
    const double by = p == &other ? kTurned : 0;
    for (const Sample& row : p->trajectory->samples) {
      ASSERT_GE(row.state.q[0], -0.6 + by - 1e-6);  // limits are kept by the published rows to 1e-6 of them
      ASSERT_LE(row.state.q[0], 1.2 + by + 1e-6);
    }
  }
}

// 1.570796327 rad is no more upright than pi/2 is: its sine is 1, and the arm is the same.
TEST(MountedPlans, ARoundedRightAngleIsUpright) {
  Parameters rounded = shipped();
  rounded.mounting.inclination = 1.570796327;
  rounded.mounting.gravity = std::sin(rounded.mounting.inclination);
  EXPECT_EQ(robot_hash(rounded), robot_hash(shipped()));
  rounded.mounting.gravity = std::sin(1.57);
  EXPECT_NE(robot_hash(rounded), robot_hash(shipped()));
}

TEST(MountedPlans, AnArmThatIsTurnedMovesTheSame) {
  expect_the_same_motion("");
  expect_the_same_motion(", duration: 1.0, objective: {link_acceleration: 1}");
}

// The fastest way folds the elbow to -1.47 rad on its way to -0.8, where there is room to.
TEST(MountedPlans, ALowerLimitIsKept) {
  Parameters barred = shipped();
  barred.limits.link_position[1] = (2.6 + 1.0) / 2;
  barred.limits.link_middle[1] = (2.6 - 1.0) / 2;
  const std::string request = "{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}}";
  const Plan wide = planned(request, shipped()), narrow = planned(request, barred);
  ASSERT_EQ(wide.status, PlanStatus::kCertified) << wide.reason;
  ASSERT_EQ(narrow.status, PlanStatus::kCertified) << narrow.reason;
  double lowest = 0, lowest_barred = 0;
  for (const Sample& row : wide.trajectory->samples) lowest = std::min(lowest, row.state.q[1]);
  for (const Sample& row : narrow.trajectory->samples) lowest_barred = std::min(lowest_barred, row.state.q[1]);
  EXPECT_LT(lowest, -1.1);                  // otherwise this test shows nothing
  EXPECT_GE(lowest_barred, -1.0 - 1.8e-6);  // published rows keep limits to 1e-6 of them
  EXPECT_LT(lowest_barred, -0.99);          // and go as far as they may
  EXPECT_GT(narrow.duration, wide.duration);
}

TEST(MountedPlans, GoalsOutsideTheRangeAreRefusedByIt) {
  try {
    planned(from_to(-0.5, 1.3, ""), turned(0));
    FAIL() << "a goal outside the range was planned";
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("goal.q[0]: 1.3 rad is outside [-0.6"));
  }
}

// Nothing to work against: on a table the peak torque of a slow motion is friction and inertia alone.
TEST(MountedPlans, OnATableAPostureTakesNoTorque) {
  Parameters flat = shipped();
  flat.mounting.gravity = 0;
  const Plan p = planned("{start: {q: [0, 0]}, goal: {q: [1.5, 0.5]}}", flat);
  ASSERT_EQ(p.status, PlanStatus::kCertified) << p.reason;
  const Sample& last = p.trajectory->samples.back();
  EXPECT_NEAR(last.state.theta[0], last.state.q[0], 1e-9);  // springs hold nothing at rest
}

}  // namespace
}  // namespace fjr
