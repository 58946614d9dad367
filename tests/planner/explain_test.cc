// What is said to be in the way is in the way: relaxed as said the request can be had, by a tenth less it cannot.
#include "planner/search/explain/explain.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "common/input_error.h"
#include "planner/plan.h"
#include "planner/problem/relaxable.h"
#include "planner/problem/statics.h"
#include "planner/problem/task/task.h"
#include "planner/request/request.h"
#include "planner/search/slack.h"

namespace fjr {
namespace {

using testing::HasSubstr;

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

Infeasibility impossible(const Problem& problem, int most_iterations = std::numeric_limits<int>::max()) {
  const Plan result = plan(problem, {});
  EXPECT_LT(result.iterations, most_iterations);
  EXPECT_EQ(result.status, PlanStatus::kInfeasible) << result.reason;
  EXPECT_FALSE(result.trajectory);
  EXPECT_TRUE(result.infeasibility);
  const Infeasibility why = result.infeasibility.value_or(Infeasibility{});
  EXPECT_EQ(result.reason, why.sentence);
  return why;
}

const Relaxation* find(const Infeasibility& why, const std::string& name, int joint) {
  for (const Relaxation& r : why.relaxations) {
    if (r.name == name && r.joint == joint) return &r;
  }
  return nullptr;
}

// The problem with this fraction of the change that was said to be enough.
Problem changed(Problem problem, const Relaxation& by, double fraction) {
  const double value = by.from + fraction * (by.to - by.from);
  if (by.kind == RelaxableKind::kViaTime) problem.via[0].time = value;
  if (by.kind == RelaxableKind::kBothJoints) both_joints(problem, *by.quantity).set(problem, value);
  for (const Relaxable& r : relaxables(problem)) {
    if (r.name == by.name && r.joint == by.joint) r.set(problem, value);
  }
  return problem;
}

// What is told without "about" was planned as it is told; with it, it is right to a twentieth of the change.
constexpr double kEnough = 1, kEnoughForAbout = 1.05, kTooLittle = 0.9;
enum class Told { kExactly, kOrAbout };

Plan without_explanation(const Problem& problem) {
  bool explaining = false;
  PlanOptions options;
  options.most_work = 5;  // [s] ten times what a motion takes to find that there is
  options.on_progress = [&](const Progress& p) { explaining = p.phase == Phase::kExplaining; };
  options.cancelled = [&] { return explaining; };
  return plan(problem, options);
}

void expect_enough(const Problem& problem, const Infeasibility& why, const std::string& name, int joint,
                   Told told = Told::kExactly) {
  const Relaxation* by = find(why, name, joint);
  ASSERT_NE(by, nullptr) << why.sentence;
  EXPECT_TRUE(told == Told::kOrAbout || !by->rough) << why.sentence;
  const double enough = by->rough ? kEnoughForAbout : kEnough;
  EXPECT_EQ(plan(changed(problem, *by, enough), {}).status, PlanStatus::kCertified) << why.sentence;
}

void expect_least(const Problem& problem, const Infeasibility& why, const std::string& name, int joint,
                  Told told = Told::kExactly) {
  expect_enough(problem, why, name, joint, told);
  const Relaxation* by = find(why, name, joint);
  ASSERT_NE(by, nullptr);
  EXPECT_NE(without_explanation(changed(problem, *by, kTooLittle)).status, PlanStatus::kCertified) << why.sentence;
}

std::string refusal(const std::string& yaml) {
  try {
    request(yaml);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Explain, WhatCannotBeHeldIsRefusedWithWhatHoldingTakes) {
  const Parameters robot = request("{start: {q: [0.0, 0.0]}, goal: {q: [0.1, 0.0]}}").robot;
  const double at_goal = gravity_torque(robot, Joints<double>{1.5, 0.0})[0];
  EXPECT_THAT(refusal("{start: {q: [0.0, 0.0]}, goal: {q: [1.5, 0.0]}, limits: {torque: [5, 4]}}"),
              HasSubstr("takes " + std::to_string(at_goal).substr(0, 6)));
  // Link 2 helps most where it points back as far as it goes.
  const double folded = gravity_torque(robot, Joints<double>{1.5, -robot.limits.link_position[1]})[0];
  EXPECT_THAT(refusal("{start: {q: [0.0, 0.0]}, goal: {q: [1.5, free]}, limits: {torque: [5, 4]}}"),
              HasSubstr("takes at least " + std::to_string(folded).substr(0, 6)));
  EXPECT_EQ(refusal("{start: {q: [0.0, 0.0]}, goal: {q: [1.5, free]}, limits: {torque: [5.7, 4]}}"), "accepted");
}

// On the way from hanging to the upright with the arm stretched both coefficients of (8) add up, half way.
TEST(Explain, CarryingTakesTheGravityOfTheWorstPosture) {
  const Problem problem = request("{start: {q: [0.0, 0.0]}, goal: {q: [3.14159265, 0.0]}}");
  const auto [needed, posture] = carrying(problem);
  const Joints<double> g = gravity_coefficients(problem.robot);
  EXPECT_NEAR(needed.torque[0], g[0] + g[1], 1e-4);  // a grid of 0.016 rad misses the top by cos(0.008)
  EXPECT_NEAR(needed.torque[1], g[1], 1e-4);
  EXPECT_NEAR(posture[0][0], std::numbers::pi / 2, 0.01);
  EXPECT_NEAR(needed.spring_deflection[0], needed.torque[0] / problem.robot.spring.stiffness[0], 1e-12);
  EXPECT_EQ(needed.motor_velocity[0], 0);
}

// Too heavy for joint 1 on every slow way, and swung up only by more than the search found within a fifth of the usual
// work: a motion with all limits relaxed exceeds the torque of joint 2 by more, but with joint 1's it could be carried.
TEST(Explain, NamesTheTorqueLimitWhereNoSwingUpIsFound) {
  const Problem problem = request("{start: {q: [0, 0]}, goal: {q: [2.2, 0]}, limits: {torque: [5.5, 5]}}");
  PlanOptions options;
  options.most_work /= 5;
  const Plan result = plan(problem, options);
  ASSERT_TRUE(result.infeasibility);
  EXPECT_EQ(result.infeasibility->limit, "torque") << result.infeasibility->sentence;
  EXPECT_EQ(result.infeasibility->joint, 1) << result.infeasibility->sentence;
  EXPECT_THAT(result.infeasibility->sentence, HasSubstr("holding the arm still on the straight path"));
}

// The rows of an obstacle that is relaxed and those of the smaller one say the same about every posture.
TEST(Explain, AnObstacleGivesWayAsItsRadiusShrinks) {
  const Problem problem = request(
      "{start: {q: [-1.0, 0.0]}, goal: {q: [1.0, 0.0]}, obstacles: [{center: [0.0, -0.9], radius: 0.1, margin: "
      "0.01}]}");
  const Relaxable what = relaxables(problem)[8];
  ASSERT_EQ(what.name, "obstacles[0]");
  const double slack = 0.4;
  const Problem smaller = what.relaxed(problem, what.from - value_with(problem, what, slack));
  const Problem relaxed = with_slack(problem, what, SlackSettings{});
  const auto before = task_rows(problem.robot, problem.task, 0), after = task_rows(problem.robot, smaller.task, 0);
  EXPECT_NEAR(value_with(problem, what, 1), 0, 1e-12);
  for (const double q1 : {-0.3, 0.0, 0.2}) {
    const auto posture = Posture<double>::of(problem.robot, {q1, 0.1});
    for (std::size_t r = 0; r < before.size(); ++r) {
      const double given = slack * relaxed.variation.slack->direction[kLimits + r];
      const bool allowed = before[r].value(problem.robot, posture) + given >= 0;
      EXPECT_LE(allowed, after[r].value(problem.robot, posture) >= -1e-12) << "the told radius suffices";
    }
  }
}

TEST(Explain, ADurationThatIsTooShort) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, duration: {max: 0.41}, objective: fastest}");
  const Infeasibility why = impossible(problem);
  EXPECT_EQ(why.limit, "duration");
  ASSERT_TRUE(why.shortest_duration);
  EXPECT_NEAR(*why.shortest_duration, 0.4297, 0.005 * 0.4297);  // the converged reference
  const Relaxation* longer = find(why, "duration", 0);
  ASSERT_NE(longer, nullptr);
  EXPECT_EQ(longer->to, *why.shortest_duration);
  expect_least(problem, why, "torque", 1);
}

Plan fastest(Problem problem) {
  problem.weights = {.time = 1};
  problem.duration = {kShortestDuration, kLongestDuration};
  PlanOptions options;
  options.starts = 2;
  return plan(problem, options);
}

// As a rule the shortest duration falls ever less with every further growth of a limit, so that its shadow price tells
// the least that has to change. Limits are left untried because of it: those for which that is more than they are.
TEST(Explain, NoLimitSavesMoreThanItsShadowPriceSays) {
  constexpr double kOfPrices = 0.05;  // regularisation and friction of the two motions differ by some per cent
  int told = 0, hopeless = 0;
  for (const char* const q : {"[1.2, -0.8]", "[0.5, 1.0]", "[-1.0, 0.6]"}) {
    const std::string ways = std::string("{start: {q: [0, 0]}, goal: {q: ") + q + "}";
    const Problem unhurried = request(ways + "}");
    const Plan best = fastest(unhurried);
    ASSERT_EQ(best.status, PlanStatus::kCertified) << best.reason;
    ASSERT_TRUE(best.analysis);
    const double shortest = best.trajectory->end_time(), allowed = 0.96 * shortest;
    const Infeasibility why =
        impossible(request(ways + fmt::format(", duration: {:.6f}, objective: efficient}}", allowed)));
    for (const Relaxable& limit : relaxables(unhurried)) {
      double price = 0;
      for (const ShadowPrice& s : best.analysis->sensitivity.limits) {
        if (s.name == limit.name && s.joint == limit.joint) price = s.price;
      }
      if (const Relaxation* r = find(why, limit.name, limit.joint)) {
        EXPECT_GE(price * (r->to - r->from), (1 - kOfPrices) * (shortest - allowed)) << why.sentence;
        ++told;
      } else if (price > 0 && price * limit.from < (1 - kOfPrices) * (shortest - allowed)) {
        const Plan twice = fastest(limit.relaxed(unhurried, limit.from));
        if (twice.status != PlanStatus::kCertified) continue;
        EXPECT_GT(twice.trajectory->end_time(), allowed) << limit.name << limit.joint;
        ++hopeless;
      }
    }
  }
  EXPECT_GT(told, 0);
  EXPECT_GT(hopeless, 0);
}

// It is the duration of the plan that a request for the fastest motion gets, from other starts.
TEST(Explain, TheShortestDurationIsThatOfTheFastestPlan) {
  for (const char* const task : {"obstacles: [{center: [0.33, -0.45], radius: 0.04}]", "via: [{q: [-0.4, 0.9]}]"}) {
    const std::string ways = std::string("{start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}, ") + task;
    const Plan best = fastest(request(ways + "}"));
    ASSERT_EQ(best.status, PlanStatus::kCertified) << best.reason;
    const double shortest = best.trajectory->end_time();
    const Infeasibility why =
        impossible(request(ways + fmt::format(", duration: {:.6f}, objective: efficient}}", 0.6 * shortest)));
    ASSERT_TRUE(why.shortest_duration) << why.sentence;
    // Minima of fastest motions are closer to each other than that, and the duration is rounded up.
    EXPECT_NEAR(*why.shortest_duration, shortest, 2e-3 * shortest);
    const Plan told = plan(request(ways + fmt::format(", duration: {{max: {:.6f}}}}}", *why.shortest_duration)), {});
    EXPECT_EQ(told.status, PlanStatus::kCertified) << told.reason;
  }
}

// No motor turns from one rest to another faster than at its limit all the way.
TEST(Explain, AMotorThatIsTooSlow) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, duration: 1.0, limits: {motor_velocity: [0.8, 8]}}");
  const Infeasibility why = impossible(problem);
  ASSERT_TRUE(why.shortest_duration);
  const double turn = (*problem.goal.theta)[0];
  EXPECT_GT(*why.shortest_duration, turn / 0.8);
  const Relaxation* longer = find(why, "duration", 0);
  ASSERT_NE(longer, nullptr);
  EXPECT_NEAR(longer->to, 1.01 * *why.shortest_duration, 1e-3);  // to spare, for the objective is not time
  const Relaxation* by = find(why, "motor_velocity", 1);
  ASSERT_NE(by, nullptr) << why.sentence;
  EXPECT_GT(by->to, turn / 1.0);
  expect_enough(problem, why, "motor_velocity", 1);
}

// Each joint alone has too far to go for its motor; with both limits relaxed it can be had.
TEST(Explain, BothMotorsThatAreTooSlow) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, duration: 1.0, limits: {motor_velocity: [0.9, 0.6]}}");
  const Infeasibility why = impossible(problem);
  const Relaxation* by = find(why, "motor_velocity", 0);
  ASSERT_NE(by, nullptr) << why.sentence;
  EXPECT_EQ(by->kind, RelaxableKind::kBothJoints);
  EXPECT_GT(by->to, (*problem.goal.theta)[0] / 0.9);  // no motor goes there in 1 s at less
  expect_enough(problem, why, "motor_velocity", 0);
}

TEST(Explain, AGoalThatMovesTooFast) {
  const Problem problem = request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8], dq: [20, 0]}}");
  const Infeasibility why =
      impossible(problem, 7000);  // 780 to 3907 measured, by roundings; 14,768 before a velocity was asked about first
  EXPECT_EQ(why.limit, "goal.dq");
  expect_least(problem, why, "goal.dq", 0, Told::kOrAbout);  // with some roundings it is planned as told, with some not
}

TEST(Explain, AViaPointThatComesTooEarly) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, via: [{q: [0.6, -0.4], time: 0.15}], goal: {q: [1.2, -0.8]}, duration: 1.0}");
  const Infeasibility why = impossible(problem, 1600);  // 813 measured
  EXPECT_EQ(why.limit, "via[0].time");
  expect_enough(problem, why, "via[0].time", 0);  // that it is the least is a minimum time, tested elsewhere
}

// The grid finds a way as soon as the disc is 0.03 m smaller; along it no motion is found.
TEST(Explain, ADiscThatBarsEveryWay) {
  const Problem problem = request(
      "{start: {q: [-0.9, 0.0]}, goal: {q: [0.9, 0.0]}, limits: {link_position: [1.2, 2.5]}, obstacles: [{center: "
      "[0.089, -0.444], radius: 0.104}, {center: [-0.246, -0.632], radius: 0.116}]}");
  const Infeasibility why = impossible(problem);
  EXPECT_THAT(why.sentence, HasSubstr("every path from the start to the goal"));
  expect_enough(problem, why, "obstacles[0]", 0);
}

// The least slack of a coarse mesh lets the motion cut the disc's corner between the collocation points: the radius
// that came of it took 0.2 ms more than there was.
TEST(Explain, ARadiusThatIsNamedIsEnoughAsItIsNamed) {
  const Problem problem = request(
      "{start: {q: [-0.77, 0.0]}, goal: {q: [0.77, 0.0]}, duration: {max: 0.4575}, obstacles: [{center: [-0.06, "
      "-0.67], "
      "radius: 0.042}]}");
  const Infeasibility why = impossible(problem);
  const Relaxation* by = find(why, "obstacles[0]", 0);
  ASSERT_NE(by, nullptr) << why.sentence;
  EXPECT_FALSE(by->rough);
  EXPECT_EQ(plan(changed(problem, *by, 1), {}).status, PlanStatus::kCertified) << why.sentence;
}

// Limits would have to be more than twice as large, which is more than any disc is: it is told all the same that a
// smaller disc would do.
TEST(Explain, ADiscIsNamedHoweverMuchAllLimitsLack) {
  const Infeasibility why = impossible(request(
      "{start: {q: [-0.8, 0.0]}, goal: {q: [0.8, 0.0]}, duration: {max: 0.47}, obstacles: [{center: [0.0, -0.80], "
      "radius: 0.42}]}"));
  EXPECT_NE(find(why, "obstacles[0]", 0), nullptr) << why.sentence;
}

// With the elbow on the left the arc cannot be followed to this goal; with the elbow on the right torque is missing.
TEST(Explain, OfAlternativeGoalsAnOpenOneIsToldOf) {
  PlanOptions options;
  options.search.budget.finding = options.search.budget.refining = 0.05;
  options.search.budget.fallbacks = 0;
  options.starts = 1;
  const Plan barred =
      plan(request("{start: {q: [0.3, -0.6]}, goal: {tip: [0.257005, 0.565412], elbow: any}, limits: {torque: [4.5, "
                   "5]}, tip: {arc: "
                   "{center: [0, 0], from: [0.011821, -0.620969], to: [0.257005, 0.565412], tolerance: 0.01}}}"),
           options);
  EXPECT_THAT(barred.reason, testing::Not(HasSubstr("the elbow stays")));
  EXPECT_THAT(barred.reason, HasSubstr("torque of joint 1"));
}

// What is told in four digits is never less of a change than what was found.
TEST(Explain, ToldNumbersAreRoundedToTheSafeSide) {
  EXPECT_EQ(told(0.01, 0.0126001), 0.01261);
  EXPECT_EQ(told(0.01, 0.0126), 0.0126);
  EXPECT_EQ(told(0.104, 0.0608299), 0.06082);
  EXPECT_EQ(told(5, 9.99951), 10);
  EXPECT_EQ(told(0.1, 0), 0);
}

}  // namespace
}  // namespace fjr
