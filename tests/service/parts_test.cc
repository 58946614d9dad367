// What waits for whom, and what is kept of clients: the parts of the service that need neither processes nor DDS nor
// time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "planner/service/admission.h"
#include "planner/service/backlog.h"
#include "planner/service/outbox.h"
#include "planner/service/presence.h"
#include "planner/service/recent_ids.h"
#include "planner/service/turns.h"
#include "planner/service/unclaimed.h"

namespace fjr {
namespace {

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

SharedReply reply_of(const RequestId& id, const Origin& participant) {
  Reply reply;
  reply.id = id;
  reply.origin = participant;
  return std::make_shared<const Reply>(reply);
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
