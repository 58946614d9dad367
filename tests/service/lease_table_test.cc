// The owner's book of leases: without processes, DDS and clocks.
#include "planner/service/lease_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fjr {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::array<std::uint8_t, 16> kOwner{1}, kOther{2};
constexpr WorkerId kA{0xa}, kB{0xb};
constexpr LeaseTable::Clock::time_point kStart{};

Job job(std::uint64_t number) {
  Job job;
  job.order.id.number = number;
  return job;
}

WorkerOffer offer(const WorkerId& worker, std::uint32_t slots, const std::vector<LeaseId>& held = {}) {
  WorkerOffer offer;
  offer.worker = worker;
  offer.slots = slots;
  for (const LeaseId& lease : held) offer.held.push_back({lease, {}});
  return offer;
}

std::vector<std::uint64_t> numbers(const std::vector<Job>& jobs) {
  std::vector<std::uint64_t> numbers;
  for (const Job& job : jobs) numbers.push_back(job.order.id.number);
  return numbers;
}

class Leases : public testing::Test {
 protected:
  Leases() { table_.own(5); }

  std::optional<LeaseTable::Choice> least() const {
    return table_.least_loaded([](const WorkerId&) { return true; });
  }

  LeaseTable table_{kOwner};
};

TEST_F(Leases, GoToTheLeastLoadedWorkerWithAFreeSlot) {
  EXPECT_FALSE(least());
  table_.heard(offer(kA, 4), kStart);
  table_.heard(offer(kB, 2), kStart);
  std::vector<WorkerId> order;
  for (std::uint64_t i = 0; i < 6; ++i) {
    ASSERT_TRUE(least());
    order.push_back(least()->worker);
    table_.grant(least()->worker, job(i), kStart);
  }
  EXPECT_THAT(order, ElementsAre(kA, kB, kA, kA, kB, kA));  // at 0, 0, 1/4, 1/2, 1/2 and 3/4 of what they have
  EXPECT_FALSE(least());
  EXPECT_EQ(table_.slots(), 6u);
}

TEST_F(Leases, AreNotGivenToWhoIsFullOrCannotBeReached) {
  table_.heard(offer(kA, 1), kStart);
  EXPECT_FALSE(table_.least_loaded([](const WorkerId&) { return false; }));
  table_.full(kA);
  EXPECT_FALSE(least());
  table_.heard(offer(kA, 1), kStart);  // it says itself when that is over
  EXPECT_TRUE(least());
  table_.heard(offer(kA, 1, {{kOther, 6, 1}}), kStart);  // a later owner's, who will do for it
  EXPECT_FALSE(least());
}

TEST_F(Leases, AreExtendedByOffersThatNameThemAndRunOutOtherwise) {
  table_.heard(offer(kA, 2), kStart);
  const LeaseId one = table_.grant(kA, job(1), kStart);
  table_.grant(kA, job(2), kStart);
  table_.heard(offer(kA, 2, {one}), kStart + kLeaseTime);
  EXPECT_THAT(table_.expired(kStart + kLeaseTime), IsEmpty());
  EXPECT_THAT(numbers(table_.expired(kStart + kLeaseTime + milliseconds(1))), ElementsAre(2u));
  EXPECT_THAT(numbers(table_.expired(kStart + 2 * kLeaseTime + milliseconds(1))), ElementsAre(1u));
  EXPECT_THAT(table_.jobs(), IsEmpty());
}

// The other one cannot extend or end it.
TEST_F(Leases, BelongToOneWorker) {
  table_.heard(offer(kA, 1), kStart);
  const LeaseId lease = table_.grant(kA, job(1), kStart);
  EXPECT_THAT(table_.heard(offer(kB, 1, {lease}), kStart + kLeaseTime), ElementsAre(lease));
  EXPECT_FALSE(table_.take(lease, kB));
  EXPECT_THAT(numbers(table_.expired(kStart + kLeaseTime + milliseconds(1))), ElementsAre(1u));
}

TEST_F(Leases, AreTakenOnce) {
  table_.heard(offer(kA, 1), kStart);
  const LeaseId lease = table_.grant(kA, job(7), kStart);
  EXPECT_EQ(table_.take(lease, kA)->order.id.number, 7u);
  EXPECT_FALSE(table_.take(lease, kA));
  EXPECT_FALSE(table_.take({kOther, 5, lease.number}, kA));
}

// What ran out was granted to somebody else, and counts no more.
TEST_F(Leases, ThatRanOutAreNotTaken) {
  table_.heard(offer(kA, 1), kStart);
  table_.heard(offer(kB, 1), kStart);
  const LeaseId lost = table_.grant(kA, job(7), kStart);
  std::vector<Job> jobs = table_.lost(kA);
  ASSERT_THAT(numbers(jobs), ElementsAre(7u));
  const LeaseId again = table_.grant(kB, std::move(jobs.front()), kStart);
  EXPECT_FALSE(table_.take(lost, kA));
  EXPECT_THAT(table_.heard(offer(kA, 1, {lost}), kStart), ElementsAre(lost));  // it is told so
  EXPECT_TRUE(table_.take(again, kB));
}

// Of owners that follow each other the later one ends what the earlier one has granted, never the other way round.
TEST_F(Leases, OfEarlierOwnersAreOver) {
  const LeaseId earlier{kOther, 4, 1}, same{kOther, 5, 1}, later{kOther, 6, 1};
  EXPECT_THAT(table_.heard(offer(kA, 3, {earlier, same, later}), kStart), ElementsAre(earlier, same));
}

TEST_F(Leases, SilentWorkersAreFound) {
  table_.heard(offer(kA, 1), kStart);
  table_.heard(offer(kB, 1), kStart + milliseconds(1));
  EXPECT_THAT(table_.silent(kStart + kLeaseTime), IsEmpty());
  EXPECT_THAT(table_.silent(kStart + kLeaseTime + milliseconds(1)), ElementsAre(kA));
}

TEST_F(Leases, AreStoppedByWhatTheyAreFor) {
  table_.heard(offer(kA, 2), kStart);
  table_.grant(kA, job(1), kStart);
  const LeaseId two = table_.grant(kA, job(2), kStart);
  const auto stopped = table_.stop_if([](const Job& job) { return job.order.id.number == 2; });
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->lease, two);
  EXPECT_EQ(stopped->worker, kA);
  EXPECT_FALSE(table_.take(two, kA));
  EXPECT_EQ(table_.jobs().size(), 1u);
}

}  // namespace
}  // namespace fjr
