// Who owns a robot, what waits for whom: the parts of the service that need neither processes nor DDS nor time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <thread>

#include "planner/protocol/epoch.h"
#include "planner/results/repetition_json.h"
#include "planner/service/admission.h"
#include "planner/service/backlog.h"
#include "planner/service/executed_runs.h"
#include "planner/service/executor_watch.h"
#include "planner/service/outbox.h"
#include "planner/service/ownership.h"
#include "planner/service/presence.h"
#include "planner/service/recent_ids.h"
#include "planner/service/refused_repetitions.h"
#include "planner/service/turns.h"
#include "planner/service/unclaimed.h"

namespace fjr {
namespace {

using testing::HasSubstr;

// Both hear of each other whatever was decided before.
void meet(Ownership& a, Ownership& b) {
  a.heard("b", "arm", b.epoch());
  b.heard("a", "arm", a.epoch());
}

// Two services that share one slot.
struct TwoInTurn {
  std::shared_ptr<Turns> turns = std::make_shared<Turns>(1);
  int woken_a = 0, woken_b = 0;
  Turn a{turns, [this] { ++woken_a; }}, b{turns, [this] { ++woken_b; }};
};

TEST(Turns, WhoHadOneLongestAgoIsNext) {
  TwoInTurn two;
  ASSERT_TRUE(two.a.ask());
  two.a.begin();
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(two.a.ask());
    EXPECT_FALSE(two.b.ask());
    two.a.end();
    EXPECT_EQ(two.woken_b, i + 1);
    EXPECT_FALSE(two.a.ask());  // however often it asks
    ASSERT_TRUE(two.b.ask());
    two.b.begin();
    two.b.end();
    EXPECT_EQ(two.woken_a, i + 1);
    ASSERT_TRUE(two.a.ask());
    two.a.begin();
  }
}

TEST(Turns, WhoHasNothingToSolveStandsInNobodysWay) {
  TwoInTurn two;
  ASSERT_TRUE(two.a.ask());
  two.a.begin();
  EXPECT_FALSE(two.a.ask());
  EXPECT_FALSE(two.b.ask());
  two.b.withdraw();  // before it is its turn
  two.a.end();
  ASSERT_TRUE(two.a.ask());
  EXPECT_FALSE(two.b.ask());
  two.a.withdraw();  // with a slot kept for it
  EXPECT_EQ(two.woken_b, 1);
  EXPECT_TRUE(two.b.ask());
  EXPECT_TRUE(two.b.ask());  // the same
  EXPECT_FALSE(two.a.ask());
}

TEST(Turns, AloneItIsAlwaysItsTurn) {
  const Turn alone;
  EXPECT_TRUE(alone.ask());
  alone.begin();
  EXPECT_TRUE(alone.ask());
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

SharedReply reply_to(std::uint8_t client, std::uint64_t number, std::size_t rows = 0) {
  Reply reply;
  reply.id.client[0] = client;
  reply.id.number = number;
  reply.rows.resize(rows);
  return std::make_shared<const Reply>(std::move(reply));
}

void deliver_when_due(Outbox& outbox) {
  std::this_thread::sleep_until(outbox.next());
  outbox.deliver();
}

TEST(Outbox, KeepsEachClientsOrderAndMakesNoOtherWait) {
  bool blocked = true;
  std::vector<std::pair<int, std::uint64_t>> sent;
  Outbox outbox(
      [&](const SharedReply& reply) {
        if (blocked && reply->id.client[0] == 1) return false;
        sent.emplace_back(reply->id.client[0], reply->id.number);
        return true;
      },
      1 << 20);
  for (std::uint64_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(outbox.post(reply_to(1, i)));
    EXPECT_TRUE(outbox.post(reply_to(2, i)));
  }
  EXPECT_EQ(sent, (std::vector<std::pair<int, std::uint64_t>>{{2, 0}, {2, 1}, {2, 2}}));
  deliver_when_due(outbox);
  EXPECT_FALSE(outbox.empty());
  blocked = false;
  sent.clear();
  deliver_when_due(outbox);
  EXPECT_EQ(sent, (std::vector<std::pair<int, std::uint64_t>>{{1, 0}, {1, 1}, {1, 2}}));
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, IsBoundedAtTheCostOfWhoIsFurthestBehind) {
  bool blocked = true;
  std::vector<std::pair<int, std::uint64_t>> sent;
  Outbox outbox(
      [&](const SharedReply& reply) {
        if (!blocked) sent.emplace_back(reply->id.client[0], reply->id.number);
        return !blocked;
      },
      1 << 20);
  EXPECT_TRUE(outbox.post(reply_to(2, 0)));
  bool all_kept = true;
  for (std::uint64_t i = 0; i < 5; ++i) all_kept = outbox.post(reply_to(1, i, 4096)) && all_kept;  // 360 kB each
  EXPECT_FALSE(all_kept);
  blocked = false;
  deliver_when_due(outbox);
  EXPECT_EQ(sent, (std::vector<std::pair<int, std::uint64_t>>{{1, 3}, {1, 4}, {2, 0}}));
}

// More than are looked at in a turn, none of which has room: whoever has is found all the same.
TEST(Outbox, FindsWhoHasRoomAmongVeryMany) {
  constexpr int kClients = 3000;
  int with_room = -1;
  std::vector<int> sent;
  const auto number = [](const RequestId& id) { return id.client[0] * 256 + id.client[1]; };
  Outbox outbox(
      [&](const SharedReply& reply) {
        if (number(reply->id) == with_room) sent.push_back(with_room);
        return number(reply->id) == with_room;
      },
      64 << 20);
  for (int i = 0; i < kClients; ++i) {
    Reply reply;
    reply.id.client[0] = static_cast<std::uint8_t>(i / 256);
    reply.id.client[1] = static_cast<std::uint8_t>(i % 256);
    outbox.post(std::make_shared<const Reply>(std::move(reply)));
  }
  for (with_room = kClients - 1; with_room > 0; with_room -= 1000) {
    const std::size_t before = sent.size();
    for (int turn = 0; turn < 4 && sent.size() == before; ++turn) deliver_when_due(outbox);
    EXPECT_EQ(sent.size(), before + 1) << with_room;
  }
}

TEST(Backlog, RemembersTheLatestUnanswered) {
  Backlog backlog(3);
  Order order;
  for (std::uint64_t i = 0; i < 5; ++i) {
    order.id.number = i;
    const auto dropped = backlog.add(order, {}, {}, false);
    ASSERT_EQ(dropped.has_value(), i >= 3);
    EXPECT_EQ(dropped ? dropped->id.number : 0, i >= 3 ? i - 3 : 0);
  }
  EXPECT_FALSE(backlog.add(order, {}, {}, false));  // asked for again
  order.id.number = 3;
  backlog.answered(order.id);
  order.id.number = 4;
  EXPECT_FALSE(backlog.cancel(order, {}, false));
  const auto entries = backlog.take_if([](const Backlog::Entry&) { return true; });
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].order.id.number, 2u);
  EXPECT_FALSE(entries[0].cancelled);
  EXPECT_TRUE(entries[1].cancelled);
}

// In whatever order the two come.
TEST(Backlog, ARequestStaysCancelled) {
  Backlog backlog(3);
  Order cancelled, asked;
  cancelled.origin[0] = asked.origin[0] = 1;
  asked.document = "goal: {q: [0, 0]}";
  backlog.cancel(cancelled, {}, true);
  backlog.accepted(asked.id);  // by somebody who may know nothing of the cancellation
  EXPECT_LT(backlog.next_relay(), Backlog::Clock::time_point::max());
  backlog.add(asked, {}, {}, true);
  const auto entries = backlog.take_if([](const Backlog::Entry&) { return true; });
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_TRUE(entries[0].cancelled);
  EXPECT_TRUE(entries[0].asked);
  EXPECT_EQ(entries[0].order.document, asked.document);
}

// Whoever cancels what nobody knows, as often as it likes, costs others nothing, and its own latest are kept.
TEST(Backlog, CancellationsOfOneTakeNoPlaceFromAnother) {
  Backlog backlog(4);
  Order healthy, flood;
  healthy.origin[0] = 1;
  flood.origin[0] = 2;
  backlog.add(healthy, {}, {}, false);
  for (flood.id.number = 1; flood.id.number < 100; ++flood.id.number) {
    EXPECT_FALSE(backlog.cancel(flood, {}, false));  // nobody has asked for what is dropped
  }
  const auto entries = backlog.take_if([](const Backlog::Entry&) { return true; });
  ASSERT_EQ(entries.size(), 4u);
  EXPECT_EQ(entries[0].order.origin, healthy.origin);
  EXPECT_EQ(entries[3].order.id.number, 99u);
}

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

SharedReply reply_of(const RequestId& id, const Origin& participant) {
  Reply reply;
  reply.id = id;
  reply.origin = participant;
  return std::make_shared<const Reply>(reply);
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

// One client may ask ten thousand times before DDS has told where it listens.
TEST(Unclaimed, KeepsWhateverOneClientAskedInOrder) {
  Unclaimed unclaimed(128, 64U << 20U);
  RequestId id = new_client();
  for (id.number = 0; id.number < 10000; ++id.number) unclaimed.keep(reply_of(id, Origin{1}));
  const auto claimed = unclaimed.claim([](const RequestId&) { return true; });
  ASSERT_EQ(claimed.size(), 10000U);
  for (std::size_t i = 0; i < claimed.size(); ++i) ASSERT_EQ(claimed[i]->id.number, i);
  EXPECT_EQ(unclaimed.bytes(), 0U);
}

// Ids cost nothing to invent: of one participant only so many are kept, and nobody else's.
TEST(Unclaimed, KeepsFewOfTheClientsThatOneParticipantInvents) {
  Unclaimed unclaimed(128, 64U << 20U);
  const RequestId other = new_client();
  unclaimed.keep(reply_of(other, Origin{2}));
  for (int i = 0; i < 10000; ++i) unclaimed.keep(reply_of(new_client(), Origin{1}));
  EXPECT_EQ(unclaimed.claim([&](const RequestId& id) { return id == other; }).size(), 1U);
  EXPECT_EQ(unclaimed.claim([](const RequestId&) { return true; }).size(), 128U);
}

TEST(Unclaimed, IsBoundedInBytesAtTheCostOfWhoHasMost) {
  const std::size_t one = size_of(*reply_of(new_client(), Origin{1}));
  Unclaimed unclaimed(128, 20 * one);
  const RequestId many = new_client(), few = new_client();
  unclaimed.keep(reply_of(few, Origin{2}));
  for (int i = 0; i < 100; ++i) unclaimed.keep(reply_of(many, Origin{1}));
  EXPECT_LE(unclaimed.bytes(), 20 * one);
  EXPECT_EQ(unclaimed.claim([&](const RequestId& id) { return id.client == few.client; }).size(), 1U);
  unclaimed.forget_older_than({});
  EXPECT_EQ(unclaimed.bytes(), 0U);
}

// An executor runs 20 s at most, and no message holds the stop motions of more.
TEST(Admission, WhatIsTooLongToBeExecutedIsRefusedAndMayBePlanned) {
  const Parameters robot = load_parameters(default_robot_file());
  Job job;
  job.order.name = "request";
  job.order.document = "{start: {q: [0, 0]}, goal: {q: [0.5, 0]}, duration: 25}";
  ASSERT_FALSE(read_motion(job.order));
  job.request = *job.order.motion;
  EXPECT_FALSE(refusal_of_motion(job, robot));
  job.order.action = Action::kPlanAndExecute;
  const auto refusal = refusal_of_motion(job, robot);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->field, "duration");
  EXPECT_EQ(refusal->sentence, "25 s is longer than the 20 s that an executor runs");
}

// Below half a second a client that is there could not be asked in time, and would be taken for gone.
TEST(Admission, StartWithinIsLongEnoughToAsk) {
  Order order;
  const auto field_of = [&](double seconds) {
    order.start_within = seconds;
    const auto refusal = refusal_of_terms(order, {"arm", {"arm"}, "", 600});
    return refusal ? refusal->field : "";
  };
  EXPECT_EQ(field_of(0), "");
  EXPECT_EQ(field_of(0.5), "");
  EXPECT_EQ(field_of(0.49), "start_within");
  EXPECT_EQ(field_of(601), "start_within");
}

// Who takes over from an owner that died has heard nothing yet of its clients, which may take a moment to meet it.
TEST(Presence, AClientThatIsMetHasAsMuchTimeToAnswerAsOneThatIsKnown) {
  using std::chrono::milliseconds;
  Order order;
  order.id = {{1}, 1};
  const Presence::Clock::time_point now{std::chrono::hours(1)};
  for (const double start_within : {0.0, 3.0}) {
    order.action = start_within > 0 ? Action::kPlanAndExecute : Action::kPlan;
    order.start_within = start_within;
    const milliseconds patience{start_within > 0 ? 3000 : 5000};
    Presence met, known;
    met.heard(order.id, {});
    known.heard(order.id, now);
    EXPECT_TRUE(met.is_due(order, now));
    EXPECT_FALSE(met.may_start(order, now));  // nothing moves for it
    EXPECT_FALSE(met.gone(order, now));
    EXPECT_FALSE(known.is_due(order, now));
    const auto asked = now + patience / 4 + milliseconds(1);
    EXPECT_TRUE(known.is_due(order, asked));
    met.asked(order.id, asked);
    known.asked(order.id, asked);
    const auto over = asked + patience * 3 / 4;
    for (const Presence& one : {met, known}) {
      EXPECT_FALSE(one.gone(order, over - milliseconds(1)));
      EXPECT_TRUE(one.gone(order, over + milliseconds(2)));
    }
    met.heard(order.id, over);
    EXPECT_FALSE(met.gone(order, over + milliseconds(2)));
    EXPECT_TRUE(met.may_start(order, over));
  }
}

TEST(RecentIds, AreForgottenByAgeAndByNumber) {
  using namespace std::chrono_literals;
  const auto now = RecentIds::Clock::now();
  RecentIds ids(2, 5s);
  const RequestId first = new_client(), second = new_client(), third = new_client();
  ids.add(first, {}, now);
  ids.add(second, {}, now + 1s);
  EXPECT_TRUE(ids.contains(first, now + 5s));
  EXPECT_FALSE(ids.contains(first, now + 6s));
  EXPECT_FALSE(ids.contains(third, now));
  ids.add(third, {}, now + 2s);
  EXPECT_FALSE(ids.contains(first, now + 2s));
  EXPECT_TRUE(ids.contains(second, now + 2s));
}

TEST(RecentIds, OfOneTakeNoPlaceFromAnother) {
  const auto now = RecentIds::Clock::now();
  RecentIds ids(3, std::chrono::seconds(5));
  const RequestId healthy = new_client();
  RequestId last;
  ids.add(healthy, {1}, now);
  for (int i = 0; i < 10; ++i) ids.add(last = new_client(), {2}, now);
  EXPECT_TRUE(ids.contains(healthy, now));
  EXPECT_TRUE(ids.contains(last, now));
}

}  // namespace
}  // namespace fjr
