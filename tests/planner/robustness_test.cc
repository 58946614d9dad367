// Requests that can be had for certain are planned, whatever they are made of.
#include <gtest/gtest.h>

#include <algorithm>

#include "planner/plan.h"
#include "planner/request/request.h"
#include "support/random_requests.h"

namespace fjr {
namespace {

// A few of what bench/random_requests.cc writes by the hundred; short motions, so that this stays cheap.
TEST(Robustness, RandomFeasibleRequestsAreCertified) {
  constexpr int kWanted = 6;
  constexpr double kShort = 0.6;  // [s]
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  int planned = 0;
  for (std::uint64_t seed = 1001; planned < kWanted; ++seed) {
    const RandomRequest request = random_request(robot, seed);
    if (request.duration > kShort) continue;
    ++planned;
    PlanOptions options;
    options.starts = 1;  // the best is not asked for, but any
    const Plan result = plan(parse_request(request.yaml, "random.yaml", robot), options);
    EXPECT_EQ(result.status, PlanStatus::kCertified)
        << "seed " << seed << ", " << request.kind << ": " << result.reason << "\n"
        << request.yaml;
  }
}

// The straight arm takes 6.7 N m when it is level, eq. (8): with 6.1 it has to swing first, which no start converges to
// within the usual number of iterations. 1.813 s measured; the first solution that is far from it takes 6.5 s.
TEST(Robustness, WhatCannotBeLiftedIsSwungUp) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const Plan result = plan(parse_request("start: {q: [0, 0]}\n"
                                         "goal: {q: [2.6, 0]}\n"
                                         "objective: fastest\n"
                                         "limits: {torque: [6.1, 4]}\n",
                                         "lift.yaml", robot),
                           {});
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LT(result.duration, 1.9);
  double back = 0;  // [rad] that link 1 swings away from its goal
  for (const Sample& row : result.trajectory->samples) back = std::min(back, row.state.q[0]);
  EXPECT_LT(back, -0.5);
}

TEST(Robustness, RandomRequestsAreTheSameForTheSameSeed) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  EXPECT_EQ(random_request(robot, 7).yaml, random_request(robot, 7).yaml);
  EXPECT_NE(random_request(robot, 7).yaml, random_request(robot, 8).yaml);
}

}  // namespace
}  // namespace fjr
