// Several executors for one robot, as processes: one of them goes on, and nobody moves while there are two.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "planner/protocol/claim.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

TEST(Claim, OfTwoExactlyOneGivesWay) {
  std::vector<Claimant> all;
  for (const bool moved : {false, true}) {
    for (const bool established : {false, true}) {
      for (const std::uint8_t guid : {std::uint8_t{1}, std::uint8_t{2}}) all.push_back({moved, established, {guid}});
    }
  }
  for (const Claimant& a : all) {
    for (const Claimant& b : all) {
      if (a.guid != b.guid) {
        EXPECT_NE(gives_way(a, b), gives_way(b, a));
      }
    }
  }
  EXPECT_TRUE(gives_way({.established = true, .guid = {1}}, {.moved = true, .established = true, .guid = {2}}));
  EXPECT_TRUE(gives_way({.guid = {1}}, {.established = true, .guid = {2}}));
  EXPECT_TRUE(gives_way({.established = true, .guid = {2}}, {.established = true, .guid = {1}}));
}

// Says that the arm rests, whoever else does.
class Impostor {
 public:
  explicit Impostor(unsigned domain) : participant_(domain), states_(participant_, participant_.handle()) {
    thread_ = std::jthread([this](const std::stop_token& over) {
      ExecutorState state;
      state.robot_id = "arm";
      while (!over.stop_requested()) {
        (void)states_.write(dds::encode(state));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }

 private:
  dds::Participant participant_;
  dds::Writer<fjr_msg_ExecutorState> states_;
  std::jthread thread_;
};

class SeveralExecutors : public ServiceProcesses {
 protected:
  std::unique_ptr<Process> executor(const std::string& name) const {
    return fjr({"executor", "--start", "0.3,0.2", "--state", path(name)}, name + ".log");
  }
  static bool says(const Process& process, const std::string& text) {
    return process.output().find(text) != std::string::npos;
  }
  static bool runs(const Process& process) {
    return comes_true([&] { return says(process, "executing for"); });
  }
};

TEST_F(SeveralExecutors, TheSecondDoesNotStartAndOneStartedAfterAKillDoes) {
  auto first = executor("first");
  ASSERT_TRUE(runs(*first));
  const auto second = executor("second");
  EXPECT_EQ(second->wait(), 1);
  EXPECT_THAT(second->output(), HasSubstr("another executor of robot 'arm' is running on DDS domain"));
  EXPECT_FALSE(says(*second, "executing for"));
  const auto other_robot = fjr({"executor", "--robot-id", "other", "--state", path("other")}, "other.log");
  EXPECT_TRUE(runs(*other_robot));

  first->send(SIGKILL);
  (void)first->wait();
  const auto third = executor("third");
  EXPECT_TRUE(runs(*third)) << third->output();
}

TEST_F(SeveralExecutors, OfTwoThatStartAtOnceOneGoesOn) {
  for (int i = 0; i < 3; ++i) {
    const auto a = executor("a"), b = executor("b");
    ASSERT_TRUE(comes_true([&] { return says(*a, "another executor") || says(*b, "another executor"); }));
    const bool a_goes_on = says(*b, "another executor");
    EXPECT_EQ((a_goes_on ? b : a)->wait(), 1);
    EXPECT_TRUE(runs(a_goes_on ? *a : *b));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_FALSE(says(a_goes_on ? *a : *b, "another executor"));
  }
}

// The first one is not heard while the second one starts, as with a network that is interrupted.
TEST_F(SeveralExecutors, OfTwoThatMeetLateOneGivesWay) {
  const auto a = executor("a");
  ASSERT_TRUE(runs(*a));
  a->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto b = executor("b");
  ASSERT_TRUE(runs(*b)) << b->output();
  a->send(SIGCONT);
  ASSERT_TRUE(comes_true([&] { return says(*a, "this one gives way") || says(*b, "this one gives way"); }));
  const bool a_goes_on = says(*b, "this one gives way");
  EXPECT_EQ((a_goes_on ? b : a)->wait(), 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(says(a_goes_on ? *a : *b, "this one gives way"));
}

// To be about to move is not to have moved: otherwise each would give way to the other.
TEST_F(SeveralExecutors, OfTwoThatMeetWhilePreparingTheSameOneGivesWay) {
  const Parameters robot = load_parameters(default_robot_file());
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_Trajectory> trajectories(participant, participant.handle());
  const auto a = executor("a");
  ASSERT_TRUE(runs(*a));
  ASSERT_TRUE(comes_true([&] { return trajectories.readers() == 1; }));
  a->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto b = executor("b");
  ASSERT_TRUE(runs(*b)) << b->output();
  ASSERT_TRUE(comes_true([&] { return trajectories.readers() == 2; }));
  TrajectoryOrder order;
  order.robot_id = "arm";
  order.id = new_client();
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  order.published = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  order.robot_hash = robot_hash(robot);
  order.certified = order.ends_at_rest = true;
  order.rows =
      flat_motion(robot, {0.3, 0.2}, {0.9, -0.9}, 5).samples;  // without stop motions: over a second to prepare
  ASSERT_TRUE(trajectories.write(dds::encode(order)));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  a->send(SIGCONT);
  ASSERT_TRUE(comes_true([&] { return says(*a, "this one gives way") || says(*b, "this one gives way"); }));
  const bool a_goes_on = says(*b, "this one gives way");
  EXPECT_EQ((a_goes_on ? b : a)->wait(), 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(says(a_goes_on ? *a : *b, "this one gives way"));
}

TEST_F(SeveralExecutors, WhatWasPlannedWhenASecondOneCameIsNotExecuted) {
  write("back.yaml", "start: {q: [0.42, 0.08]}\ngoal: {q: [0.3, 0.2]}\nobjective: fastest\n");  // takes a while
  const auto service = serve();
  const auto arm = executor("arm");
  ASSERT_TRUE(runs(*arm));
  const auto moved = fjr({"request", path("quick.yaml"), "--execute"}, "moved.log");
  EXPECT_EQ(moved->wait(), 0) << moved->output();
  const auto request = fjr({"request", path("back.yaml"), "--execute"}, "back.log");
  ASSERT_TRUE(comes_true([&] { return says(*service, "name=back.yaml"); }));
  const Impostor impostor(domain_);
  EXPECT_NE(request->wait(), 0);
  EXPECT_THAT(request->output(), HasSubstr("planned, but not executed: 2 executors report for robot arm"));
  const std::string log = arm->output();
  EXPECT_EQ(log.find("executing id="), log.rfind("executing id="));
}

TEST_F(SeveralExecutors, NothingMovesWhileTwoReport) {
  write("free.yaml", "goal: {q: [0.3, 0.2]}\nduration: 1\n");
  const auto service = serve();
  const auto arm = executor("arm");
  ASSERT_TRUE(runs(*arm));
  const auto moved = fjr({"request", path("quick.yaml"), "--execute", "--out", path("out")}, "moved.log");
  EXPECT_EQ(moved->wait(), 0) << moved->output();

  const Impostor impostor(domain_);  // has moved nothing: the other one stays
  ASSERT_TRUE(comes_true([&] { return says(*arm, "another executor of robot=arm reports, too"); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // until the service has listened, too
  for (const char* what : {"free.yaml", "quick.yaml", "out"}) {
    const auto refused = fjr({"request", path(what), "--execute"}, "refused.log");
    EXPECT_EQ(refused->wait(), 1) << refused->output();
    EXPECT_THAT(refused->output(), HasSubstr("2 executors report for robot arm: all but one have to be stopped"));
  }
  const auto status = fjr({"status"}, "status.log");
  EXPECT_EQ(status->wait(), 0);
  const std::string shown = status->output();
  const std::size_t one = shown.find("executor of arm: ");
  ASSERT_NE(one, std::string::npos) << shown;
  EXPECT_NE(shown.find("executor of arm: ", one + 1), std::string::npos) << shown;
  EXPECT_FALSE(says(*arm, "gives way"));
}

}  // namespace
}  // namespace fjr
