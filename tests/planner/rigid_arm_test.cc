// The shortest times of joints that accelerate within bounds, against a search through all times, and the velocities at
// points that are passed, against any others.
#include "planner/search/rigid_arm.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/planner/parsed_request.h"

namespace fjr {
namespace {

// From rest to rest: accelerated half of the way, T = 2 sqrt(d / a); and in any longer time.
TEST(JointTransfer, BetweenRestsTakesAnyTimeFromTheShortestOn) {
  const JointTransfer transfer{.distance = -0.5, .from = 0, .to = 0, .most = 8};
  const double shortest = 2 * std::sqrt(0.5 / 8);
  EXPECT_FALSE(can_take(transfer, shortest * 0.999));
  for (const double more : {1.001, 1.5, 10.0}) EXPECT_TRUE(can_take(transfer, shortest * more)) << more;
}

// At 2 rad/s over 0.04 rad and at 2 rad/s there: in 0.02 s, or after coming round again. Braking by 50 rad/s^2 and
// accelerating again takes up to (2 v - sqrt(4 v^2 - 4 a d)) / a = 0.0234 s; going back first, from
// (2 v + sqrt(4 v^2 - 4 a d)) / a = 0.1366 s on.
TEST(JointTransfer, ThatMovesAlreadyCannotTakeTheTimesBetween) {
  const JointTransfer transfer{.distance = 0.04, .from = 2, .to = 2, .most = 50};
  const double spread = std::sqrt(4 * 4 - 4 * 50 * 0.04);
  const double longest_at_once = (4 - spread) / 50, shortest_round = (4 + spread) / 50;
  EXPECT_TRUE(can_take(transfer, 0.02));
  EXPECT_TRUE(can_take(transfer, longest_at_once * 0.999));
  EXPECT_FALSE(can_take(transfer, longest_at_once * 1.001));
  EXPECT_FALSE(can_take(transfer, shortest_round * 0.999));
  EXPECT_TRUE(can_take(transfer, shortest_round * 1.001));
}

TEST(JointTransfer, TheShortestCommonTimeIsTheFirstThatBothCanTake) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> distance(-1, 1), velocity(-5, 5), most(10, 100), least(0, 0.3);
  for (int i = 0; i < 300; ++i) {
    std::array<JointTransfer, kJoints> transfers;
    for (JointTransfer& t : transfers) t = {distance(random), velocity(random), velocity(random), most(random)};
    const double allowed = least(random), shortest = shortest_common_time(transfers, allowed);
    const auto both_can_take = [&](double time) {
      return can_take(transfers[0], time) && can_take(transfers[1], time);
    };
    ASSERT_TRUE(both_can_take(shortest)) << i;
    ASSERT_GE(shortest, allowed);
    for (double time = allowed; time < shortest * (1 - 1e-6) - 1e-6; time += 1e-4)
      ASSERT_FALSE(both_can_take(time)) << i;
  }
}

// Points that a stretch of constant velocity leads through are passed at about that velocity.
TEST(FastestPassing, KeepsWhatIsPrescribedAndPassesWhatLiesOnTheWay) {
  const Passing passing = fastest_passing(
      parse("start: {q: [0.5, -0.7], dq: [1.1, 2.3]}\nvia: [{q: [0.6, -0.4], dq: [0.9, 1.5]}, {q: [0.7, 0.1]}]\n"
            "goal: {q: [0.8, 0.9]}\n"));
  ASSERT_EQ(passing.velocities.size(), 4U);
  ASSERT_EQ(passing.times.size(), 3U);
  EXPECT_EQ(passing.velocities[0], (Joints<double>{1.1, 2.3}));
  EXPECT_EQ(passing.velocities[1], (Joints<double>{0.9, 1.5}));
  EXPECT_GT(passing.velocities[2][1], 2) << "it nearly stops at a point that it might pass";
  EXPECT_EQ(passing.velocities[3], (Joints<double>{0, 0}));
}

// Whatever velocities are prescribed where they were open, the price is no lower. The tolerance is for what the finest
// grid leaves: 1/128 of the motors' speeds.
TEST(FastestPassing, IsNoSlowerThanWithOtherVelocities) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-0.6, 0.6), velocity(-8, 8);
  for (int i = 0; i < 5; ++i) {
    std::vector<Joints<double>> points;
    for (int k = 0; k < 4; ++k) points.push_back({angle(random), angle(random)});
    const auto with = [&](const std::string& first, const std::string& second) {
      return fastest_passing(
                 parse(fmt::format(
                     "start: {{q: [{}, {}]}}\nvia: [{{q: [{}, {}]{}}}, {{q: [{}, {}]{}}}]\ngoal: {{q: [{}, {}]}}\n",
                     points[0][0], points[0][1], points[1][0], points[1][1], first, points[2][0], points[2][1], second,
                     points[3][0], points[3][1])))
          .price;
    };
    const double free = with("", "");
    for (int k = 0; k < 80; ++k) {
      const auto any = [&] { return fmt::format(", dq: [{}, {}]", velocity(random), velocity(random)); };
      const std::string first = any(), second = any();
      EXPECT_GE(with(first, second), free * 0.999) << i << first << second;
    }
  }
}

// Mirrored: so long and so fast, the other way.
TEST(FastestPassing, IsTheSameTheOtherWayRound) {
  const auto passing = [](double sign) {
    return fastest_passing(parse(fmt::format(
        "start: {{q: [{}, {}]}}\nvia: [{{q: [{}, {}]}}, {{q: [{}, {}], dq: [{}, {}]}}]\ngoal: {{q: [{}, {}]}}\n",
        0.5 * sign, -0.7 * sign, 0.6 * sign, -0.2 * sign, 0.63 * sign, -0.14 * sign, 2 * sign, 3 * sign, 0.8 * sign,
        0.9 * sign)));
  };
  const Passing one = passing(1), other = passing(-1);
  EXPECT_NEAR(one.price, other.price, 1e-9 * one.price);
}

}  // namespace
}  // namespace fjr
