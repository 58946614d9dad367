// Which of several services owns a robot, and answers a request.
#include "planner/service/ownership.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "planner/protocol/epoch.h"

namespace fjr {
namespace {

// Both hear of each other whatever was decided before.
void meet(Ownership& a, Ownership& b) {
  a.heard("b", "arm", b.epoch());
  b.heard("a", "arm", a.epoch());
}

TEST(Ownership, OfTwoThatStartTogetherOneOwns) {
  Ownership a("a", "arm"), b("b", "arm");
  meet(a, b);
  a.review();
  b.review();
  EXPECT_NE(a.owner(), b.owner());
}

TEST(Ownership, WhoJoinsTakesNothingAway) {
  for (const std::string name : {"b", "c", "d", "e", "f"}) {
    Ownership a("a", "arm"), late(name, "arm");
    EXPECT_TRUE(a.review());
    late.heard("a", "arm", a.epoch());
    a.heard(name, "arm", 0);
    EXPECT_FALSE(late.review());
    EXPECT_FALSE(a.review());
    EXPECT_TRUE(a.owner());
  }
}

TEST(Ownership, TheStandbyTakesOverWithALargerEpochAndTheOldOwnerGivesUp) {
  Ownership a("a", "arm"), b("b", "arm");
  a.review();
  b.heard("a", "arm", a.epoch());
  EXPECT_FALSE(b.review());
  b.lost("a");
  EXPECT_TRUE(b.review());
  EXPECT_GT(b.epoch(), a.epoch());
  meet(a, b);
  EXPECT_TRUE(a.review());
  EXPECT_FALSE(a.owner());
  EXPECT_FALSE(b.review());
  EXPECT_TRUE(b.owner());
}

// Two that did not see each other have the same epoch; one of them stays.
TEST(Ownership, ATieIsBroken) {
  Ownership a("a", "arm"), b("b", "arm");
  a.review();
  b.review();
  EXPECT_EQ(a.epoch(), b.epoch());
  meet(a, b);
  a.review();
  b.review();
  EXPECT_NE(a.owner(), b.owner());
}

TEST(Ownership, AnEpochIsAboveWhatTheExecutorHasSeen) {
  Ownership a("a", "arm");
  a.heard_executor(7);
  EXPECT_TRUE(a.review());
  EXPECT_EQ(a.epoch(), 8u);
  a.heard_executor(8);
  EXPECT_FALSE(a.review());
  a.heard_executor(12);  // somebody else was here, and is gone
  EXPECT_TRUE(a.review());
  EXPECT_EQ(a.epoch(), 13u);
}

// The executor refuses what is far above the epochs it has seen: nobody can push an owner up there.
TEST(Ownership, BelievesNoEpochThatTheExecutorWouldRefuse) {
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  Ownership a("a", "arm");
  a.review();
  for (const std::uint64_t epoch : {kMost, kMost - 1, kEpochJump + 1}) {
    a.heard("liar", "arm", epoch);
    EXPECT_FALSE(a.review());
    EXPECT_EQ(a.epoch(), 1u);
    EXPECT_TRUE(a.alone());
  }
  // As far as is allowed, and then as its heir.
  a.heard("liar", "arm", kEpochJump);
  EXPECT_TRUE(a.review());
  EXPECT_FALSE(a.owner());
  a.lost("liar");
  EXPECT_TRUE(a.review());
  EXPECT_EQ(a.epoch(), kEpochJump);
  // Who speaks for the executor is believed until the executor itself speaks.
  for (const std::uint64_t epoch : {kMost - 1, kMost}) {
    a.heard_executor(epoch);
    a.review();
    EXPECT_EQ(a.epoch(), kMost);
  }
  a.heard_executor(7);
  EXPECT_TRUE(a.review());
  EXPECT_EQ(a.epoch(), 8u);
}

TEST(Ownership, ARequestIsAnsweredByExactlyOne) {
  Ownership left("a", "left"), right("b", "right");
  left.heard("b", "right", 1);
  right.heard("a", "left", 1);
  left.review();
  right.review();
  for (const std::string robot : {"left", "right", "", "unknown"}) {
    EXPECT_NE(left.answers_for(robot), right.answers_for(robot)) << robot;
  }
  EXPECT_TRUE(right.answers_for("right"));
}

TEST(Ownership, FallsToTheSameOneWhoeverLooks) {
  std::map<std::string, int> owned;
  for (int robot = 0; robot < 300; ++robot) {
    const std::string id = "arm" + std::to_string(robot);
    for (const std::string name : {"a", "b", "c"}) {
      Ownership instance(name, id);
      for (const std::string other : {"a", "b", "c"}) {
        if (other != name) instance.heard(other, id, 0);
      }
      if (instance.review()) ++owned[name];
    }
  }
  // A third each: 100 +- 8.2 by chance; five of those.
  for (const std::string name : {"a", "b", "c"}) EXPECT_NEAR(owned[name], 100, 41) << name;
  EXPECT_EQ(owned["a"] + owned["b"] + owned["c"], 300);
}

}  // namespace
}  // namespace fjr
