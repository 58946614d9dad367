// Whole plans through the real optimiser and the real integrator.
#include "planner/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "planner/request/request.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

const char* const kReach = "{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, objective: fastest}";

std::string csv(const Plan& plan) {
  Trajectory rows{plan.trajectory->samples, {}};  // without the hashes
  std::ostringstream out;
  format_csv(rows, out);
  return out.str();
}

// Closest approach of the certificate's promises, read off the rows by plain means: no code of the certificate.
void expect_sound(const Problem& problem, const Plan& plan) {
  ASSERT_EQ(plan.status, PlanStatus::kCertified) << plan.reason;
  const auto& rows = plan.trajectory->samples;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) {
      ASSERT_GT(rows[i].time, rows[i - 1].time);
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_LE(std::abs(rows[i].torque[j]), problem.limits.torque[j] * (1 + 1e-6));
      EXPECT_LE(std::abs(rows[i].state.dtheta[j]), problem.limits.motor_velocity[j] * (1 + 1e-6));
      EXPECT_LE(std::abs(rows[i].state.q[j]), problem.limits.link_position[j] * (1 + 1e-6));
      EXPECT_LE(std::abs(rows[i].state.theta[j] - rows[i].state.q[j]),
                problem.limits.spring_deflection[j] * (1 + 1e-6));
    }
  }
  for (int i = 0; i < kStates; ++i) EXPECT_EQ(rows.front().state[i], problem.start[i]);
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(rows.back().state.q[j], problem.goal.q[j], 1e-8);  // ten times the optimiser's constraint tolerance
    EXPECT_NEAR(rows.back().state.dq[j], problem.goal.dq[j], 1e-8);
  }
  EXPECT_NEAR(rows.back().time, plan.duration, 1e-12);
}

TEST(Plan, MinimumTimeMeetsTheConvergedReference) {
  const Problem problem = request(kReach);
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  // 0.4297 s is the converged value of an independent transcription; half a per cent is what is promised.
  EXPECT_NEAR(result.duration, 0.4297, 0.005 * 0.4297);
  EXPECT_EQ(result.objective, result.duration);
  EXPECT_TRUE(result.certificate->open_loop.stretches.empty());
}

// The whole of plan.json, too, is compared by the test of the program.
TEST(Plan, TheSameRequestGivesTheSameBytes) {
  const Problem problem = request("{start: {q: [0.3, 0.2]}, goal: {q: [0.42, 0.08]}, objective: fastest}");
  const Plan first = plan(problem, {}), second = plan(problem, {});
  ASSERT_TRUE(first.trajectory && second.trajectory);
  EXPECT_EQ(csv(first), csv(second));
  EXPECT_EQ(first.iterations, second.iterations);
  EXPECT_EQ(first.terms, second.terms);
}

TEST(Plan, TighterLimitsTakeLongerAndAreKept) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.5, -0.3]}, objective: fastest,"
      " limits: {torque: [9, 4], motor_velocity: [4, 6], spring_deflection: [0.3, 0.2], tip_speed: 1.6}}");
  const Problem loose = request("{start: {q: [0.0, 0.0]}, goal: {q: [0.5, -0.3]}, objective: fastest}");
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  EXPECT_GT(result.duration, plan(loose, {}).duration);
  for (const LimitCheck& check : result.certificate->limits) {
    EXPECT_LE(check.reached, check.limit * (1 + 1e-6)) << check.name << ' ' << check.joint;
  }
}

TEST(Plan, ARateLimitKeepsTheCompensatedTorqueContinuous) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.5, -0.3]}, objective: fastest, limits: {torque_rate: [400, 200]}}");
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  EXPECT_TRUE(std::isfinite(result.terms.at("torque_rate")));
}

TEST(Plan, ViaPointsAreMetAtTheirTimes) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.4, -0.2]}, duration: 0.9, objective: gentle,"
      " via: [{time: 0.35, q: [0.3, 0.2]}, {time: 0.62, q: [0.45, 0.0], dq: [0.2, -1.0]}]}");
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  Interpolator at(*result.trajectory);
  for (const Via& via : problem.via) {
    const Sample s = at.at(*via.time);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_NEAR(s.state.q[j], via.q[j], 1e-6);  // cubic Hermite between rows 1 ms apart
      if (via.dq) {
        EXPECT_NEAR(s.state.dq[j], (*via.dq)[j], 1e-3);
      }
    }
  }
}

TEST(Plan, AMovingGoalIsReachedMoving) {
  const Problem problem =
      request("{start: {q: [-0.4, 0.0]}, goal: {q: [0.4, 0.2], dq: [2.0, 1.5]}, objective: fastest}");
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  EXPECT_FALSE(result.certificate->residual.evaluated);
}

// A state on a limit leaves no room for the usual base margin: the motion must not be slowed down to make some.
TEST(Plan, AStartOrAGoalOnALimitIsNoObstacle) {
  const Problem start = request("{start: {q: [3.2, 0.0]}, goal: {q: [2.8, 0.3]}, objective: fastest}");
  const Problem inside = request("{start: {q: [3.19, 0.0]}, goal: {q: [2.79, 0.3]}, objective: fastest}");
  const Plan on = plan(start, {}), near = plan(inside, {});
  expect_sound(start, on);
  expect_sound(inside, near);
  // The same motion a hundredth of a radian away, whose gravity differs by less than a per cent.
  EXPECT_NEAR(on.duration, near.duration, 0.02 * near.duration);

  const Problem beside_free = request("{start: {q: [0, 1.5]}, goal: {q: [free, 2.6]}}");
  const Plan with_free = plan(beside_free, {});
  EXPECT_EQ(with_free.status, PlanStatus::kCertified) << with_free.reason;
  EXPECT_LT(with_free.duration, 0.3);  // 0.24 s; it came to 7.4 s when margins were widened there

  const Problem goal = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.5, 0.2]}, objective: fastest, limits: {link_position: [0.5, 0.5]}}");
  const Problem free = request("{start: {q: [0.0, 0.0]}, goal: {q: [0.5, 0.2]}, objective: fastest}");
  const Plan without_overshoot = plan(goal, {}), any = plan(free, {});
  expect_sound(goal, without_overshoot);
  EXPECT_LT(without_overshoot.duration, 1.3 * any.duration);
}

TEST(Plan, AMovingGoalMayBeAtTheMotorsTopSpeed) {
  for (const char* dtheta : {"[5, 1]", "[6, 1]"}) {
    const Problem problem =
        request(std::string("{start: {q: [0.0, 0.0]}, objective: fastest, goal: {q: [0.6, 0.2], dq: [3, 1], "
                            "theta: [0.6, 0.2], dtheta: ") +
                dtheta + "}}");
    expect_sound(problem, plan(problem, {}));
  }
}

TEST(Plan, AMovingStartIsTakenAsItIs) {
  const Problem problem =
      request("{start: {q: [0.2, 0.1], dq: [0.8, -0.5]}, goal: {q: [-0.3, 0.4]}, objective: fastest}");
  expect_sound(problem, plan(problem, {}));
}

TEST(Plan, ABoundedDurationStaysWithinItsBounds) {
  const Problem problem = request(
      "{start: {q: [0.0, 0.0]}, goal: {q: [0.4, -0.2]}, duration: {min: 0.5, max: 0.9}, objective: {time: 1, "
      "effort: 0.001}}");
  const Plan result = plan(problem, {});
  expect_sound(problem, result);
  EXPECT_GE(result.duration, 0.5);
  EXPECT_LE(result.duration, 0.9);
}

TEST(Plan, TheSizeOfTheWeightsDoesNotMatter) {
  const auto with = [](const std::string& objective) {
    return plan(request("{start: {q: [0.0, 0.0]}, goal: {q: [0.4, 0.2]}, duration: 0.7, objective: " + objective + "}"),
                {});
  };
  // Factors of two leave the optimiser's numbers the same to the last bit.
  const Plan one = with("{effort: 1, link_acceleration: 0.0625}");
  const Plan tiny = with("{effort: 9.5367431640625e-07, link_acceleration: 5.9604644775390625e-08}");
  ASSERT_TRUE(one.trajectory && tiny.trajectory);
  EXPECT_EQ(one.iterations, tiny.iterations);
  EXPECT_EQ(csv(one), csv(tiny));
}

// Motor 2 cannot rest to a count: a plan that waits creeps, or is not there.
TEST(Plan, ALongWaitIsCertifiedToo) {
  const Problem problem =
      request("{start: {q: [0.0, 0.0]}, goal: {q: [0.1, 0.0]}, duration: 2.5, objective: efficient}");
  PlanOptions options;
  options.starts = 1;
  expect_sound(problem, plan(problem, options));
}

TEST(Plan, ADurationThatIsTooShortIsNamedWithTheShortestThatIsNot) {
  const Problem problem = request("{start: {q: [0.0, 0.0]}, goal: {q: [1.2, -0.8]}, duration: 0.4, objective: gentle}");
  const Plan result = plan(problem, {});
  EXPECT_EQ(result.status, PlanStatus::kInfeasible);
  EXPECT_FALSE(result.trajectory);
  EXPECT_THAT(result.reason, testing::MatchesRegex("duration: at most 0.4 s is allowed; .* takes 0\\.4[23][0-9]+ s.*"));
}

TEST(Plan, ADeadlineStopsItWithoutATrajectory) {
  PlanOptions options;
  options.deadline = 0.005;  // seconds; a plan takes more than ten times that on a fast machine, too
  const Plan result = plan(request(kReach), options);
  EXPECT_EQ(result.status, PlanStatus::kDeadline);
  EXPECT_FALSE(result.trajectory || result.certificate);
}

TEST(Plan, CancellingStopsItBetweenIterations) {
  PlanOptions options;
  int iterations = 0;
  options.on_progress = [&](const Progress&) { ++iterations; };
  options.cancelled = [&] { return iterations >= 10; };
  const Plan result = plan(request(kReach), options);
  EXPECT_EQ(result.status, PlanStatus::kCancelled);
  EXPECT_FALSE(result.trajectory);
  EXPECT_LE(iterations, 12);
}

// The whole of a published trajectory is guarded: whatever column is touched, the certificate is void.
TEST(Plan, ATamperedTrajectoryIsRefused) {
  const Problem problem = request("{start: {q: [0.3, 0.2]}, goal: {q: [0.42, 0.08]}, objective: fastest}");
  const Plan result = plan(problem, {});
  ASSERT_TRUE(result.trajectory);
  ASSERT_TRUE(certify(problem.robot, problem.limits, *result.trajectory).certified);
  const auto refused = [&](auto&& tamper) {
    Trajectory copy = *result.trajectory;
    tamper(copy.samples[copy.samples.size() / 2]);
    return !certify(problem.robot, problem.limits, copy).certified;
  };
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_TRUE(refused([&](Sample& s) { s.state.q[j] += 2e-4; }));  // two counts
    EXPECT_TRUE(refused([&](Sample& s) { s.state.dq[j] += 0.1; }));
    EXPECT_TRUE(refused([&](Sample& s) { s.state.theta[j] += 1e-3; }));
    EXPECT_TRUE(refused([&](Sample& s) { s.state.dtheta[j] += 0.1; }));
    // A single row may be one of a pair 1e-6 s apart, whose torque alone moves nothing: five milliseconds do.
    Trajectory copy = *result.trajectory;
    const double middle = result.duration / 2;
    for (Sample& s : copy.samples) {
      if (std::abs(s.time - middle) < 2.5e-3) s.torque[j] += s.torque[j] > 0 ? -0.5 : 0.5;
    }
    EXPECT_FALSE(certify(problem.robot, problem.limits, copy).certified);
  }
}

}  // namespace
}  // namespace fjr
