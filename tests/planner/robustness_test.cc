// Requests that can be had for certain are planned, whatever they are made of.
#include <gtest/gtest.h>

#include "planner/plan.h"
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

TEST(Robustness, RandomRequestsAreTheSameForTheSameSeed) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  EXPECT_EQ(random_request(robot, 7).yaml, random_request(robot, 7).yaml);
  EXPECT_NE(random_request(robot, 7).yaml, random_request(robot, 8).yaml);
}

}  // namespace
}  // namespace fjr
