// What the service hears of executors and of what they ran.
#include "planner/service/executor_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "planner/results/repetition_json.h"
#include "planner/service/executed_runs.h"
#include "planner/service/refused_repetitions.h"

namespace fjr {
namespace {

using testing::HasSubstr;

ExecutorState resting() {
  ExecutorState state;
  state.robot_id = "arm";
  state.robot_hash = "mine";
  state.q = {0.41983, 0.0814};
  state.planned_q = {0.42, 0.08};
  return state;
}

TEST(ExecutorWatch, TheArmRestsWhereItIsHeld) {
  ExecutorWatch watch("arm", "mine");
  watch.heard(resting());
  EXPECT_EQ(std::get<Joints<double>>(watch.rest()), (Joints<double>{0.42, 0.08}));
  ExecutorState pushed = resting();
  pushed.q[1] = 0.15;
  watch.heard(pushed);
  EXPECT_EQ(std::get<Joints<double>>(watch.rest()), (Joints<double>{0.42, 0.15}));
}

TEST(ExecutorWatch, SaysWhyThereIsNoRest) {
  const auto why = [](auto change) {
    ExecutorWatch watch("arm", "mine");
    ExecutorState state = resting();
    change(state, watch);
    watch.heard(state);
    const auto rest = watch.rest();
    return std::holds_alternative<std::string>(rest) ? std::get<std::string>(rest) : "";
  };
  using State = ExecutorState;
  EXPECT_EQ(why([](State& s, auto&) { s.robot_id = "other"; }), "no executor of robot arm says where the arm is");
  EXPECT_THAT(why([](State& s, auto&) { s.robot_hash = "other"; }), HasSubstr("has hash other, the service's mine"));
  EXPECT_EQ(why([](State& s, auto&) { s.mode = ExecutorMode::kExecuting; }), "the arm is executing a trajectory");
  EXPECT_EQ(why([](State& s, auto&) { s.mode = ExecutorMode::kPreparing; }),
            "the arm is about to execute a trajectory");
  EXPECT_EQ(why([](State& s, auto&) { s.mode = ExecutorMode::kStopped; }),
            "the arm is stopped until it is started again");
  EXPECT_EQ(why([](State& s, auto&) { s.q[0] = s.planned_q[0] = std::numeric_limits<double>::quiet_NaN(); }),
            "the executor says that the arm is at nan and 0.0814 rad");
  RequestId id;
  id.number = 7;
  EXPECT_EQ(why([&](State&, auto& watch) { watch.published(id); }), "the arm is about to execute a trajectory");
  EXPECT_EQ(why([&](State& s, auto& watch) {
              watch.published(id);
              s.trajectory_id = id;
            }),
            "");
  EXPECT_EQ(why([&](State&, auto& watch) {
              watch.published(id);
              watch.concluded(id);  // refused, for one
            }),
            "");
  EXPECT_EQ(why([&](State& s, auto& watch) { watch.heard(s, 1); }),
            "2 executors report for robot arm: all but one have to be stopped");
}

TEST(ExecutorWatch, KnowsAStoppedArmAsLongAsItSaysSo) {
  using namespace std::chrono_literals;
  ExecutorWatch watch("arm", "mine");
  EXPECT_FALSE(watch.stopped());  // nobody has said so
  ExecutorState state = resting();
  for (const ExecutorMode mode : {ExecutorMode::kResting, ExecutorMode::kHolding, ExecutorMode::kStopping}) {
    state.mode = mode;
    watch.heard(state);
    EXPECT_FALSE(watch.stopped());
  }
  state.mode = ExecutorMode::kStopped;
  watch.heard(state);
  EXPECT_EQ(watch.stopped(), "the arm is stopped until it is started again");
  watch.heard(state, 0, ExecutorWatch::Clock::now() - 2s);  // it may have been started again since
  EXPECT_FALSE(watch.stopped());
}

// By when it was heard, whatever its stamp says: the wall clocks of the two machines need not agree.
TEST(ExecutorWatch, AStateGetsOldBySteadyTime) {
  using namespace std::chrono_literals;
  const auto now = ExecutorWatch::Clock::now();
  ExecutorWatch watch("arm", "mine");
  watch.heard(resting(), 0, now - 2s);
  EXPECT_EQ(std::get<std::string>(watch.rest()), "the executor's last word is 2.0 s old");
  watch.heard(resting(), 0, now);
  EXPECT_TRUE(std::holds_alternative<Joints<double>>(watch.rest()));
  // One that is not heard any more is not counted, for another one was started in its place.
  watch.heard(resting(), 0, now - 1s);
  watch.heard(resting(), 1, now);
  EXPECT_FALSE(watch.twice());
}

// What is published is stamped by the executor's clock.
TEST(ExecutorWatch, ContinuesTheExecutorsClock) {
  ExecutorWatch watch("arm", "mine");
  EXPECT_NEAR(static_cast<double>(watch.stamp()), static_cast<double>(StampClock().now()), 1e9);
  ExecutorState state = resting();
  state.stamp = 1'000'000'000'000;
  watch.heard(state, 0, ExecutorWatch::Clock::now() - std::chrono::seconds(2));
  EXPECT_NEAR(static_cast<double>(watch.stamp()), 1.002e12, 1e9);
}

ExecutedRun run_of(std::uint64_t number, std::size_t rows = 2) {
  ExecutedRun run;
  run.trajectory_id.number = number;
  run.rows.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) run.rows[i].time = 0.001 * static_cast<double>(i);
  return run;
}

TEST(ExecutedRuns, TheLastOfAMotionIsFoundAndTheFirstWordOfARunCounts) {
  ExecutedRuns runs;
  for (const std::uint64_t number : {1, 2, 3, 4}) runs.add(run_of(number));
  const auto odd = [](const RequestId& id) { return id.number % 2 == 1; };
  EXPECT_EQ(runs.last(odd)->trajectory_id.number, 3U);
  runs.add(run_of(1, 5));
  EXPECT_EQ(runs.last(odd)->trajectory_id.number, 3U);
  EXPECT_EQ(runs.last([](const RequestId&) { return false; }), nullptr);
}

TEST(ExecutedRuns, WhatWasNeverLoggedIsLeftOut) {
  ExecutedRuns runs;
  runs.add(run_of(1, 1));
  ExecutedRun backwards = run_of(2, 3), none = run_of(3, 3);
  backwards.rows[2].time = backwards.rows[1].time;
  none.rows[1].planned_theta[1] = std::nan("");
  runs.add(backwards);
  runs.add(none);
  EXPECT_EQ(runs.last([](const RequestId&) { return true; }), nullptr);
}

TEST(ExecutedRuns, AreBounded) {
  ExecutedRuns runs;
  for (std::uint64_t number = 1; number <= 65; ++number) runs.add(run_of(number));
  EXPECT_FALSE(runs.contains({{}, 1}));
  EXPECT_TRUE(runs.contains({{}, 2}));
  constexpr std::size_t kTicks = 30000;  // 2.6 MB
  for (std::uint64_t number = 101; number <= 130; ++number) runs.add(run_of(number, kTicks));
  EXPECT_FALSE(runs.contains({{}, 101}));
  EXPECT_TRUE(runs.contains({{}, 110}));
}

TEST(RefusedRepetitions, TheLeastOfARunCounts) {
  RefusedRepetitions refused;
  EXPECT_FALSE(refused.of("a"));
  refused.add("a", 0.5);
  refused.add("a", 1);  // once more what had been refused before it
  refused.add("b", 1);
  EXPECT_EQ(refused.of("a"), 0.5);
  EXPECT_EQ(refused.of("b"), 1);
  for (int i = 0; i < 100; ++i) refused.add(std::to_string(i), 0.25);
  EXPECT_FALSE(refused.of("a"));
  EXPECT_EQ(refused.of("99"), 0.25);
}

TEST(RefusedRepetitions, WhatNobodyCanReadIsNone) {
  const auto taken = correction_in(R"({"repetition": {"run": "a", "fraction": 0.5}})");
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->run, "a");
  EXPECT_EQ(taken->fraction, 0.5);
  for (const char* plan_json :
       {"", "{", "[]", "null", "{}", R"({"repetition": null})", R"({"repetition": {"run": "a"}})",
        R"({"repetition": {"run": 1, "fraction": 0.5}})", R"({"repetition": {"run": "a", "fraction": null}})",
        R"({"repetition": {"run": "a", "fraction": 0}})", R"({"repetition": {"run": "a", "fraction": -1}})"}) {
    EXPECT_FALSE(correction_in(plan_json)) << plan_json;
  }
}

}  // namespace
}  // namespace fjr
