// Penalties on accelerations, for springs that have time to swing: which problems have them, and how they are taken
// back.
#include "planner/search/acceleration_penalty.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "planner/request/request.h"
#include "planner/search/follow.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

const std::string kMove = "start: {q: [0, 0]}\ngoal: {q: [0.6, -0.4]}\n";

TEST(AccelerationPenalty, IsForObjectivesThatLeaveTorquesFreeAndHaveTime) {
  const auto is_penalised = [](const std::string& more) {
    return with_acceleration_penalty(request(kMove + more), {}) != nullptr;
  };
  EXPECT_TRUE(is_penalised("duration: 5\nobjective: {energy: 1}\n"));
  EXPECT_TRUE(is_penalised("duration: 5\nobjective: {peak_torque: 1}\n"));
  EXPECT_FALSE(is_penalised("duration: 0.8\nobjective: {energy: 1}\n"));
  EXPECT_FALSE(is_penalised("duration: 5\nobjective: {effort: 1}\n"));
  EXPECT_FALSE(is_penalised("duration: 5\nobjective: {energy: 1, link_acceleration: 0.1}\n"));
  EXPECT_FALSE(is_penalised("objective: fastest\n"));
}

// A minimum-jerk motion over the distance d in the time T has the integral 120/7 d^2/T^3 of squared accelerations.
TEST(AccelerationPenalty, OfDampingIsAFewPercentForASmoothMotion) {
  const AccelerationPenaltySettings settings;
  const Problem problem = request("start: {q: [0, 0]}\ngoal: {q: [0.6, -0.8]}\nduration: 8\nobjective: gentle\n");
  const auto damped = with_damping(problem, 10, 8, settings);
  ASSERT_TRUE(damped);
  const double weight = damped->weights.link_acceleration - problem.weights.link_acceleration;
  double paid = 0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const double s = (i + 0.5) / kSteps, ddq = (60 * s - 180 * s * s + 120 * s * s * s) / (8.0 * 8.0);
    paid += weight * ddq * ddq * 8.0 / kSteps;  // d = 1
  }
  EXPECT_NEAR(paid, settings.part_of_objective * 10, 1e-6);  // midpoint rule: of second order in 1e-4
}

TEST(AccelerationPenalty, OfDampingIsForSlowMotionsWhoseObjectiveSeesFriction) {
  const auto is_damped = [](const std::string& more, double objective, double duration) {
    return with_damping(request(kMove + more), objective, duration, {}) != nullptr;
  };
  EXPECT_TRUE(is_damped("duration: 5\nobjective: {effort: 1}\n", 1, 5));
  EXPECT_TRUE(is_damped("objective: {time: 1, effort: 1}\n", 1, 5));
  EXPECT_FALSE(is_damped("objective: {time: 1, effort: 1}\n", 1, 0.8));
  EXPECT_FALSE(is_damped("objective: fastest\n", 1, 5));
  EXPECT_FALSE(is_damped("duration: 5\nobjective: {effort: 1}\n", 0, 5));
}

using Penalised = std::function<std::shared_ptr<const Problem>(const Problem& alternative)>;

// Expects that a motion which was found with a penalty costs less when that is taken back, though no more of it than
// was added.
void expect_taken_back(const Problem& problem, const Penalised& penalised) {
  Session session{SessionOptions{}};
  session.enter(Phase::kFinding);
  Findings found(problem);
  const Problem& asked = *found.alternatives.front();
  const auto with_penalty = penalised(asked);
  ASSERT_TRUE(with_penalty);
  try_starts({{with_penalty, first_guesses(problem, {}).front(), "start"}}, found, session);
  ASSERT_TRUE(found.certified());
  const double before = found.best->objective;
  fade_acceleration_penalty(found, session);
  EXPECT_TRUE(found.certified());
  EXPECT_LT(found.best->objective, before);
  EXPECT_GE(found.best->problem->weights.link_acceleration, asked.weights.link_acceleration);
  EXPECT_LT(found.best->problem->weights.link_acceleration, with_penalty->weights.link_acceleration);
}

TEST(AccelerationPenalty, IsTakenBack) {
  expect_taken_back(request(kMove + "duration: 2\nobjective: {energy: 1}\n"),
                    [](const Problem& alternative) { return with_acceleration_penalty(alternative, {}); });
}

// A gentle motion has a weight on accelerations of its own, which stays.
TEST(AccelerationPenalty, IsTakenBackToWhatWasAskedFor) {
  expect_taken_back(request(kMove + "duration: 2\nobjective: gentle\n"),
                    [](const Problem& alternative) { return with_damping(alternative, 1, 2, {}); });
}

}  // namespace
}  // namespace fjr
