// What is said to be in the way is in the way: relaxed as said the request can be had, by 5 % less it cannot.
#include "planner/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/plan.h"
#include "planner/problem/relaxable.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

Plan impossible(const Problem& problem) {
  Plan result = plan(problem, {});
  EXPECT_EQ(result.status, PlanStatus::kInfeasible) << result.reason;
  EXPECT_FALSE(result.trajectory);
  EXPECT_TRUE(result.infeasibility);
  if (!result.infeasibility) result.infeasibility.emplace();
  EXPECT_EQ(result.reason, result.infeasibility->sentence);
  return result;
}

// The problem with this share of the change that was said to be enough.
Problem changed(Problem problem, const Relaxation& by, double share) {
  const double value = by.from + share * (by.to - by.from);
  if (by.name == "duration") problem.duration = {problem.duration.min, value};
  if (by.name == "duration" && problem.duration.min > value - (by.to - by.from)) problem.duration.min = value;
  if (by.name == "all_limits") all_limits(problem).set(problem, value);
  for (const Relaxable& r : relaxables(problem)) {
    if (r.name == by.name && r.joint == by.joint) r.set(problem, value);
  }
  return problem;
}

// The least change is known to 4 %, and right at the edge of what is possible the optimiser may not converge.
constexpr double kEnough = 1.04;

void expect_least(const Problem& problem, const Relaxation& by) {
  EXPECT_EQ(plan(changed(problem, by, kEnough), {}).status, PlanStatus::kCertified) << by.name << " " << by.joint;
  EXPECT_EQ(plan(changed(problem, by, 0.95), {}).status, PlanStatus::kInfeasible) << by.name << " " << by.joint;
}

const Relaxation* find(const Infeasibility& why, const std::string& name, int joint) {
  for (const Relaxation& r : why.relaxations) {
    if (r.name == name && r.joint == joint) return &r;
  }
  return nullptr;
}

TEST(Explain, ADurationThatIsTooShort) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, duration: {max: 0.41}, objective: fastest}");
  const Plan result = impossible(problem);
  const Infeasibility& why = *result.infeasibility;
  EXPECT_EQ(why.limit, "duration");
  ASSERT_TRUE(why.shortest_duration);
  EXPECT_NEAR(*why.shortest_duration, 0.4297, 0.005 * 0.4297);  // the converged reference
  for (const Relaxation& by : why.relaxations) expect_least(problem, by);
  EXPECT_GE(why.relaxations.size(), 2U) << why.sentence;
}

TEST(Explain, ATorqueTooSmallToLift) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [3.1, 0.0]}, objective: fastest, duration: {max: 1.2}, "
      "limits: {torque: [4, 2]}}");
  const Plan result = impossible(problem);
  const Relaxation* torque = find(*result.infeasibility, "torque", 1);
  ASSERT_NE(torque, nullptr) << result.reason;
  EXPECT_TRUE(torque->within_robot);
  EXPECT_GT(torque->to, 4);
  expect_least(problem, *torque);
}

}  // namespace
}  // namespace fjr
