// The plan that takes longest: many starts, rest phases, friction followed to the exact law.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "planner/plan.h"
#include "planner/request/request.h"

namespace fjr {
namespace {

// Integral of tau^2 over both joints: exact for torques that are linear between rows. [N^2 m^2 s]
double effort_of_rows(const Trajectory& trajectory) {
  double effort = 0;
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const Sample &a = trajectory.samples[k], &b = trajectory.samples[k + 1];
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double x = a.torque[j], y = b.torque[j];
      effort += (b.time - a.time) * (x * x + x * y + y * y) / 3;
    }
  }
  return effort;
}

TEST(Plan, MinimumEffortMeetsTheBestKnownReference) {
  const Problem problem =
      load_request(FJR_SOURCE_DIR "/config/requests/efficient_reach.yaml", FJR_SOURCE_DIR "/config/robot.yaml");
  const Plan result = plan(problem, {});
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  // Best known of many starts on fine meshes: 22.98 N^2 m^2 s. Half a per cent is what is promised; a better optimum is
  // welcome as long as the rows are what was optimised: their own integral of tau^2 says the same.
  EXPECT_LT(result.objective, 22.98 * 1.005);
  EXPECT_NEAR(result.objective, effort_of_rows(*result.trajectory), 1e-4 * result.objective);
  EXPECT_GE(result.minima.size(), 2U);
  EXPECT_TRUE(result.certificate->open_loop.stretches.empty());

  // It has rest phases of motor 1: longer than 50 ms within ten widths of the friction step, 1.45e-4 rad/s.
  double resting = 0, longest = 0;
  const auto& rows = result.trajectory->samples;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const bool still = std::abs(rows[i].state.dtheta[0]) < 1.45e-3 && std::abs(rows[i + 1].state.dtheta[0]) < 1.45e-3;
    resting = still ? resting + rows[i + 1].time - rows[i].time : 0;
    longest = std::max(longest, resting);
  }
  EXPECT_GT(longest, 0.05);
}

// Whatever k starts come to, more of them come to as well: the first k are the same, and what was refined of them is.
// One start at a time, so that each that is refined to less than the best is seen not to take its place.
TEST(EffortPlan, MoreStartsNeverComeToLessAndAreUsed) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const char* const requests[] = {
      "{start: {q: [1.1, 0.4]}, goal: {q: [-0.2, 0.3]}, duration: 1.2, objective: efficient}",
      "{start: {q: [0.5, 0.5]}, goal: {q: [-0.5, 1.0]}, duration: 1, objective: efficient}"};
  bool better = false;
  for (const char* request : requests) {
    const Problem problem = parse_request(request, "request.yaml", robot);
    std::vector<Plan> plans;
    for (const int starts : {1, 2, 3, 4}) {
      PlanOptions options;
      options.starts = starts;
      plans.push_back(plan(problem, options));
      ASSERT_EQ(plans.back().status, PlanStatus::kCertified) << request << starts;
      if (plans.size() == 1) continue;
      const Plan& fewer = plans[plans.size() - 2];
      EXPECT_LE(plans.back().objective, fewer.objective) << request << starts;
      EXPECT_GE(plans.back().refined, fewer.refined) << request << starts;
    }
    EXPECT_GT(plans.back().refined, plans.front().refined) << request;
    better = better || plans.back().objective < plans.front().objective;
  }
  EXPECT_TRUE(better);
}

// With the exact friction law the Hamiltonian is constant along an optimum, and it is what the objective gains per
// second of duration. Motors that park at nodes of the mesh would break both: here none does.
TEST(EffortPlan, WithExactFrictionTheHamiltonianIsConstantAndTheDerivativeByTheDuration) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const auto planned = [&](double duration, std::shared_ptr<const Collocated> warm) {
    PlanOptions options;
    options.starts = 1;
    if (warm) options.warm = WarmStart{std::move(warm), "shorter"};
    return plan(parse_request("{start: {q: [1.2, 0.3]}, goal: {q: [-0.3, -0.9]}, objective: efficient, duration: " +
                                  std::to_string(duration) + "}",
                              "request.yaml", robot),
                options);
  };
  constexpr double kDuration = 0.8, kLonger = 0.808;
  const Plan shorter = planned(kDuration, nullptr);
  ASSERT_EQ(shorter.status, PlanStatus::kCertified) << shorter.reason;
  const Plan longer = planned(kLonger, shorter.solution);
  ASSERT_EQ(longer.status, PlanStatus::kCertified) << longer.reason;
  ASSERT_TRUE(longer.warm) << longer.warm_refusal.value_or("");  // the same minimum
  double mean = 0;
  for (const Plan* plan : {&shorter, &longer}) {
    const Optimality::Hamiltonian& h = plan->analysis->optimality.hamiltonian;
    EXPECT_LT(h.spread, 0.02 * plan->objective / plan->duration);  // 0.003 measured
    mean += h.mean / 2;
  }
  const double slope = (longer.objective - shorter.objective) / (kLonger - kDuration);
  EXPECT_NEAR(slope, mean, 0.01 * std::abs(mean));  // 0.0002 measured
}

Plan let_down(double duration) {
  const Parameters robot = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  PlanOptions options;
  options.starts = 1;
  return plan(parse_request(fmt::format("{{start: {{q: [1.1, 0.4]}}, goal: {{q: [-0.2, 0.3]}}, duration: {}, "
                                        "objective: efficient}}",
                                        duration),
                            "let_down.yaml", robot),
              options);
}

// Both motors park on the way. On meshes whose nodes do not move, each duration has an objective of its own, up to 1.1
// % off the others', and tells slopes from 0.10 to 0.82.
TEST(EffortPlan, ShadowPriceOfTheDurationIsTheSlopeOfTheObjective) {
  constexpr double kStep = 0.02;  // [s]
  std::vector<Plan> plans;
  for (int i = -2; i <= 2; ++i) {
    plans.push_back(let_down(1.2 + kStep * i));
    ASSERT_EQ(plans.back().status, PlanStatus::kCertified) << plans.back().reason;
  }
  const double slope = (plans.back().objective - plans.front().objective) / (4 * kStep);
  for (std::size_t i = 0; i < plans.size(); ++i) {
    EXPECT_TRUE(plans[i].analysis->optimality.hamiltonian.stationary()) << i;  // 1.0 to 1.7 %; 10 to 129 unmoved
    // Measured within 3 %. H is constant to 2 % of objective / duration, 0.0078, which is 6 % of the slope.
    EXPECT_NEAR(*plans[i].analysis->sensitivity.duration, slope, 0.1 * slope) << i;
    // Measured at most 0.05 %: meshes, and the last width of friction, differ.
    const double expected = plans.front().objective + slope * kStep * static_cast<double>(i);
    EXPECT_NEAR(plans[i].objective, expected, 2e-3 * expected) << i;
  }
}

// By the robot of config/.
Plan plan_of(const std::string& request) {
  return plan(parse_request(request, "request.yaml", load_parameters(FJR_SOURCE_DIR "/config/robot.yaml")), {});
}

// A motor that waits before the rest is a minimum of its own, which straight and displaced starts lead past: 6.7245
// with those alone, 6.5371 measured.
TEST(EffortPlan, WaitingIsOneOfTheStarts) {
  const Plan result = plan_of(
      "start: {q: [1.2, 0.3]}\ngoal: {q: [-0.3, -0.9]}\nduration: 1.6\n"
      "objective: {effort: 1, link_acceleration: 0.01}\n");
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LT(result.objective, 6.67);
}

// To hold the arm level heats its windings all the time, to let it swing down and up again takes little: 20.79 J by
// starts that keep it up, 11.02 J measured.
TEST(EffortPlan, AnArmSwingsWhereHoldingItTakesMore) {
  const Plan result =
      plan_of("start: {q: [1.33, 0.7]}\ngoal: {q: [1.25, 0.09]}\nduration: 1.33\nobjective: {copper: 1}\n");
  ASSERT_EQ(result.status, PlanStatus::kCertified) << result.reason;
  EXPECT_LT(result.objective, 12);
}

}  // namespace
}  // namespace fjr
