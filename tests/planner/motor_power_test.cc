// A limit that came in by the list of quantities alone: what is said in one place holds everywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "planner/certificate/limits.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

using testing::HasSubstr;

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

const std::string kReach = "{start: {q: [0, 0]}, goal: {q: [0.5, -0.3]}, objective: fastest";

// Seen every 10 us, which no part of the planner looks at: the power is cubic between rows 1 ms apart, so a maximum is
// missed by less than 1e-4 of what bends it within a row.
Joints<double> largest_power(const Trajectory& trajectory) {
  Interpolator at(trajectory);
  Joints<double> largest{};
  for (double t = 0; t <= trajectory.end_time(); t += 1e-5) {
    const Sample s = at.at(t);
    for (std::size_t j = 0; j < kJoints; ++j) {
      largest[j] = std::max(largest[j], std::abs(s.torque[j] * s.state.dtheta[j]));
    }
  }
  return largest;
}

TEST(MotorPower, IsKeptBetweenRowsAndReached) {
  const Plan free = plan(request(kReach + "}"), {}),
             limited = plan(request(kReach + ", limits: {motor_power: [20, 12]}}"), {});
  ASSERT_EQ(free.status, PlanStatus::kCertified);
  ASSERT_EQ(limited.status, PlanStatus::kCertified) << limited.reason;
  EXPECT_GT(largest_power(*free.trajectory)[0], 25);
  const Joints<double> power = largest_power(*limited.trajectory);
  EXPECT_LE(power[0], 20 * (1 + 1e-6));
  EXPECT_LE(power[1], 12 * (1 + 1e-6));
  EXPECT_GT(power[0], 20 * 0.998);  // the base margin and the margins take less
  EXPECT_GT(limited.duration, 1.005 * free.duration);
  const auto check = std::find_if(limited.certificate->limits.begin(), limited.certificate->limits.end(),
                                  [](const LimitCheck& c) { return c.name == "motor_power" && c.joint == 1; });
  ASSERT_NE(check, limited.certificate->limits.end());
  EXPECT_NEAR(check->reached, power[0], 1e-4 * power[0]);
}

// A moving start where the torque is a state: it may not begin above the limit either.
TEST(MotorPower, HoldsAtAMovingStartWithALimitedTorqueRate) {
  const Plan result = plan(request("{start: {q: [0, 0], dq: [2, 0], theta: [0.02, 0], dtheta: [2, 0]}, "
                                   "goal: {q: [0.8, -0.3]}, objective: fastest, "
                                   "limits: {motor_power: [12, 12], torque_rate: [4000, 2000]}}"),
                           {});
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LE(largest_power(*result.trajectory)[0], 12 * (1 + 1e-6));
}

// tau = 2 + 2000 t and dtheta = 3 + 4e6 t (1 ms - t), so |tau dtheta| is largest where its derivative vanishes between
// the rows; the motor's angle is the integral.
TEST(MotorPower, IsFoundBetweenRows) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const double h = 1e-3;
  Trajectory trajectory;
  for (const double t : {0.0, h}) {
    Sample row;
    row.time = t;
    row.torque[0] = 2 + 2000 * t;
    row.state.dtheta[0] = 3;
    row.state.theta[0] = 3 * t + 4e6 * (h * t * t / 2 - t * t * t / 3);
    trajectory.samples.push_back(row);
  }
  double largest = 0;
  for (double t = 0; t <= h; t += 1e-8) {
    largest = std::max(largest, (2 + 2000 * t) * (3 + 4e6 * t * (h - t)));
  }
  Limits limits;
  limits.motor_power = {largest * 0.999, kNoLimit};
  const LimitCheck check = check_limits(robot, limits, trajectory, {}).front();
  EXPECT_NEAR(check.reached, largest, 1e-9 * largest);
  EXPECT_FALSE(check.passed);
  EXPECT_THAT(violation(check), HasSubstr("motor_power of joint 1 reaches"));
}

TEST(MotorPower, DecidesTheHashOnlyWhereItIsAsked) {
  const std::string without = request(kReach + "}").request_hash,
                    with = request(kReach + ", limits: {motor_power: [20, 12]}}").request_hash,
                    other = request(kReach + ", limits: {motor_power: [20, 13]}}").request_hash;
  EXPECT_NE(with, without);
  EXPECT_NE(with, other);
}

TEST(MotorPower, IsNamedWhereItIsInTheWay) {
  const Plan result = plan(request(kReach + ", duration: {max: 0.45}, limits: {motor_power: [5, 30]}}"), {});
  EXPECT_EQ(result.status, PlanStatus::kInfeasible);
  ASSERT_TRUE(result.infeasibility);
  const std::vector<Relaxation>& named = result.infeasibility->relaxations;
  EXPECT_TRUE(std::any_of(named.begin(), named.end(), [](const Relaxation& r) {
    return r.name == "motor_power" && r.joint == 1 && r.unit == "W" && r.to > 5;
  }));
}

}  // namespace
}  // namespace fjr
