// Motions to start the optimiser from: where they lead, and that the arm moves as they say under their torques.
#include "planner/search/guesses.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/dynamics.h"
#include "tests/planner/parsed_request.h"

namespace fjr {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

const std::string kShortMove = "start: {q: [0, 0]}\ngoal: {q: [0.6, -0.4]}\n";

TEST(HangingGuess, GoesByWayOfTheLowestPosture) {
  Problem problem = parse("start: {q: [1.3, 0.7]}\ngoal: {q: [1.2, 0.1]}\nduration: 1.3\nobjective: {copper: 1}\n");
  const auto guess = hanging_guess(problem, 1.3);
  ASSERT_TRUE(guess);
  EXPECT_THAT(guess->state(0).q, ElementsAre(DoubleNear(1.3, 1e-12), DoubleNear(0.7, 1e-12)));
  EXPECT_THAT(guess->state(1).q, ElementsAre(DoubleNear(1.2, 1e-12), DoubleNear(0.1, 1e-12)));
  EXPECT_THAT(guess->state(0.5).q, ElementsAre(DoubleNear(0, 1e-12), DoubleNear(0, 1e-12)));
  // Its torque moves the arm as the guess says. Measured: central differences err by up to 6.5e-9 of their size.
  for (const double s : {0.1, 0.35, 0.5, 0.8}) {
    constexpr double kStep = 1e-5;
    const auto moves = compensated_dynamics(problem.robot, guess->state(s), guess->torque(s));
    const State<double> before = guess->state(s - kStep), after = guess->state(s + kStep);
    for (std::size_t i = 0; i < kStates; ++i) {
      const double difference = (after[i] - before[i]) / (2 * kStep * 1.3);
      EXPECT_NEAR(moves[i], difference, 1e-6 * (1 + std::abs(difference))) << s << " " << i;
    }
  }
  problem.robot.mounting.gravity = 0;
  EXPECT_FALSE(hanging_guess(problem, 1.3)) << "nothing pulls it down";
  EXPECT_FALSE(hanging_guess(parse(kShortMove), 1)) << "it hangs at the start";
  const Problem by_way = parse(
      "start: {q: [1.3, 0.7]}\nvia: [{time: 0.4, q: [1.0, 0.5]}]\ngoal: {q: [1.2, 0.1]}\n"
      "duration: 1.4\nobjective: {copper: 1}\n");
  const auto longest = hanging_guess(by_way, 1.4);
  ASSERT_TRUE(longest);
  EXPECT_THAT(longest->state(0.9 / 1.4).q, ElementsAre(DoubleNear(0, 1e-12), DoubleNear(0, 1e-12)));
  EXPECT_THAT(longest->state(0.4 / 1.4).q, ElementsAre(DoubleNear(1.0, 1e-12), DoubleNear(0.5, 1e-12)));
}

TEST(StaggeredGuess, MovesOneJointAfterTheOther) {
  const Problem problem = parse(kShortMove);
  const Guess guess = staggered_guess(problem, 1, 1);
  EXPECT_EQ(guess.state(0.39).q[0], 0);
  EXPECT_LT(guess.state(0.39).q[1], -0.2);
  EXPECT_LT(guess.state(0.61).q[0], 0.4);
  EXPECT_DOUBLE_EQ(guess.state(0.61).q[1], -0.4);
  EXPECT_THAT(guess.state(1).q, ElementsAre(DoubleNear(0.6, 1e-12), DoubleNear(-0.4, 1e-12)));
}

// Exactly through points and velocities that are given, and between them as the torque says.
TEST(PassingGuess, KeepsPointsAndVelocitiesAndMovesByItsTorque) {
  const Problem problem = parse(
      "start: {q: [0.5, -0.7], dq: [1.1, 2.3]}\nvia: [{q: [0.6, -0.4], dq: [0.9, 1.5]}, {q: [0.7, 0.1]}]\n"
      "goal: {q: [0.8, 0.9]}\n");
  const Guess guess = passing_guess(problem);
  const double duration = guess.duration();
  ASSERT_EQ(guess.durations.size(), 3U);
  const double first = guess.durations[0] / duration, second = first + guess.durations[1] / duration;
  const auto near = [](const Joints<double>& v) { return ElementsAre(DoubleNear(v[0], 1e-9), DoubleNear(v[1], 1e-9)); };
  EXPECT_THAT(guess.state(0).q, near({0.5, -0.7}));
  EXPECT_THAT(guess.state(0).dq, near({1.1, 2.3}));
  EXPECT_THAT(guess.state(first).q, near({0.6, -0.4}));
  EXPECT_THAT(guess.state(first).dq, near({0.9, 1.5}));
  EXPECT_THAT(guess.state(second).q, near({0.7, 0.1}));
  EXPECT_GT(guess.state(second).dq[1], 0.5) << "it stops at a point that it might pass";
  EXPECT_THAT(guess.state(1).q, near({0.8, 0.9}));
  EXPECT_THAT(guess.state(1).dq, near({0, 0}));
  for (const double s : {0.3 * first, 0.5 * (first + second), 0.4 + 0.6 * second}) {
    constexpr double kStep = 1e-5;
    const auto moves = compensated_dynamics(problem.robot, guess.state(s), guess.torque(s));
    const State<double> before = guess.state(s - kStep), after = guess.state(s + kStep);
    for (std::size_t i = 0; i < kStates; ++i) {
      const double difference = (after[i] - before[i]) / (2 * kStep * duration);
      // Measured: central differences err by up to 2e-8 of their size.
      EXPECT_NEAR(moves[i], difference, 1e-6 * (1 + std::abs(difference))) << s << " " << i;
    }
  }
}

// With time to spare it does not swing out with the acceleration that the springs have at the start: with all of that,
// link 2 would leave its range.
TEST(PassingGuess, HardlyOvershootsWithTimeToSpare) {
  const Guess guess = passing_guess(
      parse("start: {q: [0, 0], dq: [1, 1], theta: [0.3, 0.2]}\nvia: [{q: [0.2, 0.3]}]\ngoal: {q: [0.5, 0.6]}\n"
            "objective: {effort: 1}\nduration: 4\n"));
  for (double s = 0; s <= 1; s += 0.01) {
    for (const double q : guess.state(s).q) EXPECT_LT(std::abs(q), 1.5) << s;
  }
}

// Mirrored: so long and so fast, the other way. A joint that passes close points at a high velocity hardly changes it.
TEST(PassingGuess, IsTheSameTheOtherWayRound) {
  const auto guess_of = [](double sign) {
    return passing_guess(parse(fmt::format(
        "start: {{q: [{}, {}], dq: [{}, {}]}}\nvia: [{{q: [{}, {}], dq: [{}, {}]}}]\ngoal: {{q: [{}, {}]}}\n",
        0.5 * sign, -0.7 * sign, 2 * sign, -2 * sign, 0.53 * sign, -0.74 * sign, 2 * sign, -2 * sign, 0.8 * sign,
        -0.9 * sign)));
  };
  const Guess guess = guess_of(1), mirrored = guess_of(-1);
  EXPECT_THAT(mirrored.durations, testing::Pointwise(testing::DoubleNear(1e-12), guess.durations));
  EXPECT_LT(guess.durations[0], 0.04) << "it goes back and comes again";  // 0.02 s at 2 rad/s
  for (const double s : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    for (std::size_t i = 0; i < kStates; ++i) EXPECT_NEAR(mirrored.state(s)[i], -guess.state(s)[i], 1e-9) << s;
  }
}

}  // namespace
}  // namespace fjr
