// Guesses round obstacles: they are motions of the arm, keep clear, and lead to motions.
#include "planner/search/clear_guesses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/dynamics.h"
#include "planner/plan.h"
#include "planner/request/request.h"
#include "planner/search/continuation.h"
#include "planner/search/session.h"
#include "planner/search/starts.h"

namespace fjr {
namespace {

Problem request(const std::string& yaml) {
  return parse_request(yaml, "request.yaml", FJR_SOURCE_DIR "/config", FJR_SOURCE_DIR "/config/robot.yaml");
}

// The straight way leads through each of these discs.
const std::vector<std::string> kBarred{
    "start: {q: [-1.0137, 0.1162]}\ngoal: {q: [0.6938, 0.6367]}\nduration: 1\nobjective: {energy: 1}\n"
    "obstacles: [{center: [-0.0466, -0.5223], radius: 0.0349}]\n",
    "start: {q: [-0.4228, -0.6983]}\ngoal: {q: [0.3622, -0.8551]}\nduration: 2\nobjective: {effort: 1}\n"
    "obstacles: [{center: [-0.1558, -0.4745], radius: 0.0217}]\n",
    "start: {q: [0.8335, -0.9989]}\ngoal: {q: [-0.6967, 0.8205]}\nduration: 3\nobjective: {copper: 1}\n"
    "obstacles: [{center: [-0.0072, -0.6028], radius: 0.0319}]\n",
    "start: {q: [-0.9, 0.3]}\nvia: [{q: [0.1, -0.6]}]\ngoal: {q: [0.8, 0.4]}\nduration: 2\nobjective: {effort: 1}\n"
    "obstacles: [{center: [-0.27, -0.5], radius: 0.03}, {center: [0.36, -0.45], radius: 0.03}]\n"};

bool round_obstacles(const Guess& guess) { return guess.name.starts_with("smoothly round obstacles"); }

// The time derivative of the states against the model, by differences over 2e-4 of the duration. Their error is of
// second order in that, relative to the fourth derivative of the springs' deflection, which the fastest sine sets.
TEST(ClearGuesses, AreMotionsOfTheArm) {
  constexpr double kStep = 1e-4, kTolerance = 1e-4;  // measured: 1.7e-5 at most
  for (const std::string& yaml : kBarred) {
    const Problem problem = request(yaml);
    int checked = 0;
    for (const Guess& guess : guesses_of(starts_of(problem, 12, {}))) {
      if (!round_obstacles(guess)) continue;
      ++checked;
      double largest = 0, wrong = 0;
      for (double s = 0.03; s < 0.98; s += 0.0391) {
        const State<double> before = guess.state(s - kStep), after = guess.state(s + kStep);
        const State<double> f = compensated_dynamics(problem.robot, guess.state(s), guess.torque(s));
        for (std::size_t j = 0; j < kJoints; ++j) {
          const double time = 2 * kStep * guess.duration();
          for (const auto& [rate, model] : {std::pair{(after.dq[j] - before.dq[j]) / time, f.dq[j]},
                                            std::pair{(after.dtheta[j] - before.dtheta[j]) / time, f.dtheta[j]}}) {
            largest = std::max(largest, std::abs(model));
            wrong = std::max(wrong, std::abs(rate - model));
          }
        }
      }
      EXPECT_LT(wrong, kTolerance * largest) << guess.name << "\n" << yaml;
    }
    EXPECT_GE(checked, 2) << yaml;
  }
}

TEST(ClearGuesses, PassObstaclesAndThePlainOnesDoNot) {
  constexpr double kCutCorners = 0.015;  // [m] by eight sines in place of a path; measured: 0.010
  for (const std::string& yaml : kBarred) {
    const Problem problem = request(yaml);
    EXPECT_FALSE(keeps_clear(problem, straight_guess(problem, problem.duration.max))) << yaml;
    for (const Guess& guess : guesses_of(starts_of(problem, 12, {}))) {
      EXPECT_GT(clearance_from_obstacles(problem, guess), -kCutCorners) << guess.name << "\n" << yaml;
    }
  }
}

// Up to a corner and back. What eight sines leave of a triangle of height h is 8 h / pi^2 (1/81 + 1/121 + ...) < 0.051
// h at the corner, where it is largest, and 64 points in place of all add 1 % of h at most.
TEST(ClearGuesses, FollowTheirPathAtThePaceOfMinimumJerk) {
  constexpr double kHeight = 0.5;
  const Problem problem = request("start: {q: [0, 0]}\ngoal: {q: [1, 0]}\nduration: 1\n");
  const Guess guess = smooth_path_guess(problem, 1, {{{0, 0}, {0.5, kHeight}, {1, 0}}});
  for (double c = 0; c <= 1; c += 0.01) {
    const double pace = c * c * c * (10 + c * (-15 + c * 6));
    EXPECT_NEAR(guess.state(c).q[0], pace, 0.06 * kHeight) << c;
    EXPECT_NEAR(guess.state(c).q[1], kHeight * (1 - std::abs(2 * pace - 1)), 0.06 * kHeight) << c;
  }
}

TEST(ClearGuesses, BeginAndEndAsRequested) {
  for (const std::string& yaml : kBarred) {
    const Problem problem = request(yaml);
    for (const Guess& guess : guesses_of(starts_of(problem, 12, {}))) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(guess.state(0).q[j], problem.start.q[j], 1e-9) << guess.name;
        EXPECT_NEAR(guess.state(1).q[j], problem.goal.q[j], 1e-9) << guess.name;
      }
    }
  }
}

// Of guesses through the obstacle one of three leads to a motion.
TEST(ClearGuesses, MostlyLeadToMotions) {
  const auto problem = std::make_shared<const Problem>(request(kBarred.front()));
  const Starts starts = starts_of(*problem, 12, {});
  Session session{SessionOptions{}};
  session.enter(Phase::kFinding);
  int tried = 0, led_somewhere = 0;
  for (const StartGuess& start : starts.guesses) {
    if (!start.by_interior_point || start.near_the_best) continue;
    ++tried;
    Continuation c(problem, session, "start", {.by_interior_point = true});
    if (c.begin(start.guess, 200) != StartOutcome::kNoSolution) ++led_somewhere;
  }
  EXPECT_GE(tried, 6);
  EXPECT_GE(led_somewhere, tried / 2);
}

// The arm of the fourth request can go by way of hanging; on a table there is no such posture.
TEST(ClearGuesses, HangWhereGravityPulls) {
  Problem problem = request(kBarred.back());
  const auto any_hanging = [&] {
    const std::vector<Guess> guesses = guesses_of(starts_of(problem, 12, {}));
    return std::any_of(guesses.begin(), guesses.end(),
                       [](const Guess& guess) { return round_obstacles(guess) && guess.name.ends_with("hanging"); });
  };
  EXPECT_TRUE(any_hanging());
  problem.robot.mounting.gravity = 0;
  EXPECT_FALSE(any_hanging());
}

// What is tried where the first start along a path leads nowhere: a motion of the arm from start to goal along the same
// path. Objectives that see friction have such starts anyway, and along a given path there is nothing to choose.
TEST(ClearGuesses, ForThePathsOfOtherObjectivesAreASecondTry) {
  const std::string move = "start: {q: [-1.0137, 0.1162]}\ngoal: {q: [0.6938, 0.6367]}\n";
  const std::string disc = "obstacles: [{center: [-0.0466, -0.5223], radius: 0.0349}]\n";
  const Problem problem = request(move + disc);
  const Starts starts = starts_of(problem, 1, {});
  ASSERT_GE(count_along_paths(starts), 1U);
  for (std::size_t i = 0; i < count_along_paths(starts); ++i) {
    const Guess &first = starts.guesses[i].guess, &second = *starts.guesses[i].along_path_again;
    EXPECT_EQ(first.name, "round obstacles");
    EXPECT_TRUE(round_obstacles(second)) << second.name;
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_NEAR(second.state(0).q[j], problem.start.q[j], 1e-9);
      EXPECT_NEAR(second.state(1).q[j], problem.goal.q[j], 1e-9);
    }
  }
  const auto second_tries = [&](const std::string& more) {
    return count_along_paths(starts_of(request(move + more), 1, {}));
  };
  EXPECT_EQ(second_tries(""), 0U);
  EXPECT_EQ(second_tries(disc + "duration: 1\nobjective: {energy: 1}\n"), 0U);
  EXPECT_EQ(second_tries(disc + "path: {points: [[-0.2, 0.9]], tolerance: 0.1}\n"), 0U);
}

// No start leads anywhere in two iterations, so that all that are worth trying are, and those along paths twice.
TEST(ClearGuesses, PathsAreTriedASecondTime) {
  const Problem problem = request(
      "start: {q: [-1.0137, 0.1162]}\ngoal: {q: [0.6938, 0.6367]}\n"
      "obstacles: [{center: [-0.0466, -0.5223], radius: 0.0349}]\n");
  PlanOptions options;
  options.search.follow.iterations = 2;
  options.search.budget.fallbacks = 0;
  options.search.fallbacks.iterations = options.search.fallbacks.patient_iterations = 1;
  options.search.explanation.solves.budget = 0;
  const Starts starts = starts_of(problem, 1, options.search.starts);
  ASSERT_GT(count_along_paths(starts), 0U);
  const auto expected = starts.enough + count_along_paths(starts);
  EXPECT_EQ(plan(problem, options).starts, static_cast<int>(expected));
}

// Where nothing is in the way, where only time counts, and along a given path the starts are the usual ones.
TEST(ClearGuesses, AreForObjectivesThatSeeFrictionAmongObstacles) {
  const std::string disc = "obstacles: [{center: [-0.0466, -0.5223], radius: 0.0349}]\n";
  const std::string move = "start: {q: [-1.0137, 0.1162]}\ngoal: {q: [0.6938, 0.6367]}\n";
  const std::string energy = "duration: 1\nobjective: {energy: 1}\n";
  const auto any = [](const std::string& yaml) {
    const std::vector<Guess> guesses = guesses_of(starts_of(request(yaml), 12, {}));
    return std::any_of(guesses.begin(), guesses.end(), round_obstacles);
  };
  EXPECT_TRUE(any(move + energy + disc));
  EXPECT_FALSE(any(move + energy));
  EXPECT_FALSE(any(move + disc));
  EXPECT_FALSE(any(move + energy + disc + "path: {points: [[-0.2, 0.9]], tolerance: 0.1}\n"));
}

}  // namespace
}  // namespace fjr
