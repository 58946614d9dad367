// A service on three machines whose processes, cables and network fail: every request is answered once. Requests take
// 0.1 s, of waiting (`--rehearse`), so that two cores can show it, but for the last test's, which are planned;
// bench/machines_bench has the long runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "planner/trajectory/trajectory.h"
#include "tests/service/fleet.h"

namespace fjr {
namespace {

const std::string kAny = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n";
constexpr double kTakes = 0.1;  // [s] a request
constexpr int kSlots = 4;       // of each machine

class MachinesNetworkTest : public testing::Test {
 protected:
  void SetUp() override { begin(kTakes); }
  void begin(double rehearsal) {
    std::filesystem::create_directories(folder_);
    fleet_ = std::make_unique<Fleet>(folder_, rehearsal);
    if (!fleet_->possible()) GTEST_SKIP() << "no machines of our own here: only root can have network namespaces";
  }
  void TearDown() override {
    if (HasFailure()) {
      for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
        if (entry.path().extension() != ".log") continue;
        std::fputs((entry.path().filename().string() + ":\n" + contents(entry.path())).c_str(), stderr);
      }
    }
    fleet_.reset();
    std::filesystem::remove_all(folder_);
  }

  // Two workers beside an owner that only hands out work; `event` happens once a third has been answered.
  Fleet::Outcome ask(std::size_t requests, const std::function<void()>& event = {}) {
    bool happened = !event;
    return fleet_->ask(std::vector<std::string>(requests, kAny), 0, 40, [&](std::size_t answers) {
      if (happened || answers < requests / 3) return;
      happened = true;
      event();
    });
  }
  void expect_answered_once(const Fleet::Outcome& outcome) {
    EXPECT_EQ(outcome.answered, outcome.asked.size());
    EXPECT_EQ(outcome.different, 0u);
    for (const auto& one : outcome.asked) EXPECT_EQ(one.reply.state, ReplyState::kFailed) << one.reply.why.sentence;
    std::printf("%zu answers in %.2f s\n", outcome.answered, outcome.seconds);
  }

  Fleet& fleet() { return *fleet_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("fjr_machines_" + std::to_string(::getpid()));
  std::unique_ptr<Fleet> fleet_;
};

TEST_F(MachinesNetworkTest, EveryRequestIsAnsweredThroughTheKillOfAWorkersMachine) {
  fleet().serve("owner", 0);
  const auto& first = fleet().work("first", kSlots);
  fleet().work("second", kSlots);
  ASSERT_TRUE(fleet().has_slots(2 * kSlots));
  expect_answered_once(ask(100, [&] { first.process->send(SIGKILL); }));
}

TEST_F(MachinesNetworkTest, EveryRequestIsAnsweredThroughTheKillOfTheOwner) {
  const auto& owner = fleet().serve("owner", 0);
  fleet().work("worker", kSlots);
  ASSERT_TRUE(fleet().has_slots(kSlots));
  const auto& standby = fleet().serve("standby", 0);
  for (int i = 0; i < 1000 && standby.process->output().find("as standby") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  expect_answered_once(ask(60, [&] { owner.process->send(SIGKILL); }));
  EXPECT_EQ(fleet().owner().instance, "standby");
}

TEST_F(MachinesNetworkTest, AWorkerWhoseCableWasCutWorksAgain) {
  fleet().serve("owner", 0);
  const auto& first = fleet().work("first", kSlots);
  fleet().work("second", kSlots);
  ASSERT_TRUE(fleet().has_slots(2 * kSlots));
  expect_answered_once(ask(60, [&] { first.machine->cut(); }));
  EXPECT_TRUE(fleet().has_slots(kSlots));
  first.machine->mend();
  EXPECT_TRUE(fleet().has_slots(2 * kSlots));
  expect_answered_once(ask(20));
}

TEST_F(MachinesNetworkTest, EveryRequestIsAnsweredOverANetworkThatLosesOnePacketInTwenty) {
  for (const auto* member :
       {&fleet().serve("owner", 0), &fleet().work("first", kSlots), &fleet().work("second", kSlots)}) {
    member->machine->lose(50);
  }
  ASSERT_TRUE(fleet().has_slots(2 * kSlots));
  expect_answered_once(ask(100));
}

class PlannedNetworkTest : public MachinesNetworkTest {
 protected:
  void SetUp() override { begin(0); }
  // The rows that `fjr plan` writes.
  std::vector<Sample> planned_here(const std::string& document) const {
    std::ofstream(folder() / "here.yaml") << document;
    Process plan({FJR_EXECUTABLE, "plan", folder() / "here.yaml", "--out", folder() / "here", "-q"},
                 folder() / "plan.log");
    EXPECT_EQ(plan.wait(), 0) << plan.output();
    return read_csv(folder() / "here" / "trajectory.csv").samples;
  }
};

TEST_F(PlannedNetworkTest, EveryPlanIsTheOneThatIsPlannedHereThroughTheKillOfAWorkersMachine) {
  constexpr std::size_t kMotions = 3, kRequests = 12;
  fleet().serve("owner", 0);
  const auto& first = fleet().work("first", 1);
  fleet().work("second", 1);
  ASSERT_TRUE(fleet().has_slots(2));
  std::vector<std::string> documents;
  for (std::size_t i = 0; i < kRequests; ++i) {
    documents.push_back("start: {q: [0.3, 0.2]}\ngoal: {q: [0.4" + std::to_string(i % kMotions) + ", 0.08]}\n");
  }
  bool killed = false;
  const Fleet::Outcome outcome = fleet().ask(documents, 0, 60, [&](std::size_t answers) {
    if (answers >= kRequests / 3 && !std::exchange(killed, true)) first.process->send(SIGKILL);
  });
  EXPECT_EQ(outcome.answered, kRequests);
  EXPECT_EQ(outcome.different, 0u);
  for (std::size_t motion = 0; motion < kMotions; ++motion) {
    const std::vector<Sample> here = planned_here(documents[motion]);
    for (std::size_t i = motion; i < kRequests; i += kMotions) {
      const Reply& reply = outcome.asked[i].reply;
      ASSERT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
      ASSERT_EQ(reply.rows.size(), here.size());
      EXPECT_EQ(std::memcmp(reply.rows.data(), here.data(), here.size() * sizeof(Sample)), 0) << i;
    }
  }
}

}  // namespace
}  // namespace fjr
