// Two services for one robot: one answers, the other takes over; whatever happens to the first, nothing runs twice.
#include <cstdlib>
#include <thread>

#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

bool is_stopped(const Process& process) {
  return contents("/proc/" + std::to_string(process.pid()) + "/stat").find(") T ") != std::string::npos;
}

class StandbyTest : public ServiceTest {
 protected:
  using Instance = std::unique_ptr<Process>;

  Instance start(const std::string& name) {
    write(name + ".yaml", "{instance: " + name + "}\n");
    return start_fjr({"serve", "--config", path(name + ".yaml"), "--domain", domain()}, name);
  }
  Instance start_executor(const std::string& at = "0.3,0.2") {
    Instance executor = ServiceTest::start_executor(at);
    EXPECT_TRUE(says(*executor, "executing for"));
    return executor;
  }
  // a owns the robot, b is its standby.
  void start_both() {
    a_ = start("a");
    connect();
    wait_until([&] { return owner() == "a"; });
    b_ = start("b");
    wait_until([&] { return heard_.contains("b"); });
    settle();
  }

  // The one with the largest epoch.
  std::string owner() const {
    const auto largest = std::max_element(heard_.begin(), heard_.end(),
                                          [](const auto& x, const auto& y) { return x.second.epoch < y.second.epoch; });
    return largest != heard_.end() && largest->second.epoch > 0 ? largest->first : "";
  }
  std::uint64_t epoch(const std::string& name) { return heard_[name].epoch; }
  void wait_until_solving(const std::string& name) {
    wait_until([&] { return heard_[name].solving == 1; });
  }

  Order to_be_executed() {
    Order to_be = order(kMedium);
    to_be.action = Action::kPlanAndExecute;
    return to_be;
  }
  void wait_until_executed(const Process& executor) {
    wait_until([&] { return count(executor.output(), "finished id=") == 1; });
    settle();
    EXPECT_EQ(count(executor.output(), "executing id="), 1u) << executor.output();
  }

  Instance a_, b_;
};

// The lease is 500 ms; twice the second allowed for a machine that is busy with other things.
TEST_F(StandbyTest, TakesOverFromAStoppedOwnerWhichIsSupersededWhenItResumes) {
  start_both();
  EXPECT_EQ(epoch("b"), 0u);
  a_->send(SIGSTOP);
  const double took = wait_until([&] { return epoch("b") > 0; });
  std::printf("taken over after %.3f s\n", took);
  EXPECT_LT(took, 2);
  EXPECT_GT(epoch("b"), epoch("a"));
  const Order one = order(kFast);
  send(one);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  a_->send(SIGCONT);
  wait_until([&] { return epoch("a") == 0; });
  EXPECT_GT(epoch("b"), 0u);
  EXPECT_THAT(a_->output(), HasSubstr("superseded robot_id=arm"));
}

// The owner cannot be heard, and was never heard by the one that joins: the executor tells which epoch it has to be
// above.
TEST_F(StandbyTest, WhoJoinsWhileTheOwnerCannotBeReachedOwnsTheRobot) {
  a_ = start("a");
  connect();
  wait_until([&] { return owner() == "a"; });
  const Instance executor = start_executor();
  wait_for_executor();
  settle();
  const Order there = to_be_executed();
  send(there);
  EXPECT_EQ(final_reply(there.id).state, ReplyState::kSolved);
  wait_until_executed(*executor);
  const std::uint64_t ran = epoch("a");
  a_->send(SIGSTOP);
  listen_for(1);  // twice its lease
  b_ = start("b");
  wait_until([&] { return epoch("b") > ran; });
  settle();
  Order back = order("goal: {q: [0.3, 0.2]}\nobjective: fastest\n");
  back.action = Action::kPlanAndExecute;
  send(back);
  EXPECT_EQ(final_reply(back.id).state, ReplyState::kSolved);
  wait_until([&] { return count(executor->output(), "code=0") == 2; });
  a_->send(SIGCONT);
  wait_until([&] { return epoch("a") == 0; });
  EXPECT_GT(epoch("b"), ran);
  settle();
  EXPECT_EQ(count(executor->output(), "executing id="), 2u) << executor->output();
}

TEST_F(StandbyTest, WhatTheKilledOwnerHadInHandIsDoneOnceWithoutAskingAgain) {
  start_both();
  const Instance executor = start_executor();
  settle();
  const Order one = to_be_executed();
  send(one);
  wait_until_solving("a");
  a_->send(SIGKILL);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  wait_until_executed(*executor);
}

TEST_F(StandbyTest, AResumedOwnerDoesNotFinishWhatTheStandbyDid) {
  start_both();
  const Instance executor = start_executor();
  settle();
  const Order one = to_be_executed();
  send(one);
  wait_until_solving("a");
  a_->send(SIGSTOP);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  a_->send(SIGCONT);
  wait_until([&] { return epoch("a") == 0; });
  wait_until_executed(*executor);
  EXPECT_EQ(count(a_->output(), "finished id="), 0u) << a_->output();
}

// The owner is stopped, for less than the lease, while a client finds the standby.
TEST_F(StandbyTest, PassesOnWhatTheOwnerCannotHaveHeard) {
  start_both();
  for (int i = 0; i < 5; ++i) {
    a_->send(SIGSTOP);
    Process client({FJR_FIRST_REQUESTS, domain(), "1"}, path("client"));
    std::this_thread::sleep_for(milliseconds(250));
    a_->send(SIGCONT);
    (void)client.wait();
    EXPECT_EQ(client.output(), "answered=1\n");
    settle();
  }
}

// FJR_COUNT_FIRST_REQUESTS: how many of each of four processes.
TEST_F(StandbyTest, NoFirstRequestIsLost) {
  start_both();
  const char* text = std::getenv("FJR_COUNT_FIRST_REQUESTS");
  const std::string each = text == nullptr ? "25" : text;
  std::vector<Instance> clients;
  for (int i = 0; i < 4; ++i) {
    const std::vector<std::string> words{FJR_FIRST_REQUESTS, domain(), each};
    clients.push_back(std::make_unique<Process>(words, path("client" + std::to_string(i))));
  }
  for (const Instance& client : clients) {
    (void)client->wait();
    EXPECT_EQ(client->output(), "answered=" + each + "\n");
  }
}

TEST_F(StandbyTest, WhatTheKilledOwnerPlannedIsExecutedByItsId) {
  start_both();
  const Instance executor = start_executor();
  const Order planned = order(kFast);
  send(planned);
  EXPECT_EQ(final_reply(planned.id).state, ReplyState::kSolved);
  settle();
  a_->send(SIGKILL);
  wait_until([&] { return epoch("b") > 0; });
  Order execute = order("");
  execute.action = Action::kExecute;
  execute.trajectory_id = planned.id;
  send(execute);
  const Reply reply = final_reply(execute.id);
  EXPECT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
  wait_until_executed(*executor);
}

// ---- an arm does not start to move for somebody who is gone ----

class ClientDeathTest : public StandbyTest {
 protected:
  // A client that wants a motion whose planning takes far longer than it may start after its client's death.
  void ask_for_a_motion() {
    start_both();
    executor_ = start_executor("0,0");
    write("slow.yaml", kSlow + "search: thorough\n");
    client_ = start_fjr({"request", path("slow.yaml"), "--execute", "--domain", domain()}, "request");
    wait_until_solving("a");
  }
  // A client that is killed 0.1 s after it asked for a quick motion, while its service is stopped.
  void ask_an_absent_owner_and_die() {
    write("fast.yaml", kFast);
    Process client({FJR_PATIENT_CLIENT, domain(), path("fast.yaml").string()}, path("client"));
    wait_until([&] { return is_stopped(client); });
    settle();
    a_->send(SIGSTOP);
    client.send(SIGCONT);
    wait_until([&] { return says(client, "asked"); });
    std::this_thread::sleep_for(milliseconds(100));
    client.send(SIGKILL);
  }
  // 2 s after the last sign of life, or 1.5 s after it was asked; the lease of the owner where that is gone.
  void expect_given_up_by(const std::string& name) {
    const double took = wait_until([&] { return heard_[name].cancelled == 1 && heard_[name].solving == 0; }, 12);
    std::printf("given up after %.1f s\n", took);
    EXPECT_EQ(count(executor_->output(), "executing id="), 0u) << executor_->output();
  }
  // By the standby, once the client and the owner are dead. A client may have met the owner alone when it asked, and a
  // standby that has not heard of a request has nothing to give up: then all begin again.
  template <class AskAndKill>
  void expect_given_up_after(AskAndKill ask_and_kill) {
    for (int trial = 0; trial < 4; ++trial) {
      ask_and_kill();
      EXPECT_TRUE(says(*b_, "owner robot_id=arm"));
      if (b_->output().find("remembered=1") != std::string::npos) return expect_given_up_by("b");
      for (Instance* started : {&executor_, &client_, &b_, &a_}) started->reset();
      heard_.clear();
    }
    FAIL() << "of four requests the standby heard none";
  }

  Instance executor_, client_;
};

TEST_F(ClientDeathTest, OfTheClientAlone) {
  ask_for_a_motion();
  client_->send(SIGKILL);
  expect_given_up_by("a");
}

TEST_F(ClientDeathTest, OfTheClientThenOfTheOwner) {
  expect_given_up_after([&] {
    ask_for_a_motion();
    client_->send(SIGKILL);
    settle();
    a_->send(SIGKILL);
  });
}

TEST_F(ClientDeathTest, OfTheOwnerThenOfTheClient) {
  expect_given_up_after([&] {
    ask_for_a_motion();
    a_->send(SIGKILL);
    settle();
    client_->send(SIGKILL);
  });
}

// The client is killed while its service is absent: what it asked for then comes after its death.
TEST_F(ClientDeathTest, OfTheClientWhoseRequestWaitedForAnAbsentOwner) {
  a_ = start("a");
  connect();
  executor_ = start_executor();
  wait_until([&] { return owner() == "a"; });
  ask_an_absent_owner_and_die();
  std::this_thread::sleep_for(milliseconds(700));  // longer than the lease of the service
  a_->send(SIGCONT);
  expect_given_up_by("a");
  EXPECT_EQ(heard_["a"].received, 1u);
  EXPECT_THAT(a_->output(), HasSubstr("absent for"));
}

// A quick motion would be planned within the time that its client's last sign of life counts for: who takes over asks.
TEST_F(ClientDeathTest, OfClientAndOwnerAtTheSameInstant) {
  expect_given_up_after([&] {
    start_both();
    executor_ = start_executor();
    ask_an_absent_owner_and_die();
    a_->send(SIGKILL);
  });
  EXPECT_EQ(heard_["b"].received, 1u);
}

// What is only planned leaves with its client, too, whether it waits or is being solved; others have their turn. The
// worker is stopped: it need not compute what is thrown away.
TEST_F(ClientDeathTest, OfOneWhoWantsPlansOnly) {
  a_ = start("a");
  connect();
  for (const pid_t worker : a_->children()) ::kill(worker, SIGSTOP);
  write("slow.yaml", kSlow);
  std::vector<Instance> clients;
  for (const std::string name : {"one", "two", "three"}) {
    clients.push_back(
        start_fjr({"request", path("slow.yaml"), "--out", path(name), "--domain", domain()}, name + ".log"));
  }
  wait_until([&] { return heard_["a"].solving == 1 && heard_["a"].queued == 2; });
  const Order mine = order(kFast);
  send(mine);
  for (const Instance& client : clients) client->send(SIGKILL);
  EXPECT_EQ(final_reply(mine.id).state, ReplyState::kSolved);
  wait_until([&, &a = heard_["a"]] { return a.cancelled == 3 && a.solving + a.queued == 0; });
}

TEST_F(ClientDeathTest, AClientSaysHowLongItsRequestOutlivesIt) {
  a_ = start("a");
  connect();
  executor_ = start_executor();
  const auto ask_and_leave = [&](double start_within, const std::string& motion) {
    Order one = to_be_executed();
    one.id = new_client();
    one.document = motion;
    one.start_within = start_within;
    dds::ClientPort client(dds::Participant(domain_), one.id);
    while (!client.served()) client.wait(milliseconds(5));
    EXPECT_TRUE(client.send(one));
    client.wait(milliseconds(100));
  };
  // That takes seconds to be planned.
  ask_and_leave(0.5, "start: {q: [0.3, 0.2]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n");
  wait_until([&] { return heard_["a"].cancelled == 1; });
  EXPECT_EQ(count(executor_->output(), "executing id="), 0u) << executor_->output();
  ask_and_leave(30, kFast);
  wait_until_executed(*executor_);
}

// ---- what was cancelled is not done, whoever heard of it, and in whatever order ----

class CancelledTest : public StandbyTest {
 protected:
  void stop(Process& instance) {
    instance.send(SIGSTOP);
    wait_until([&] { return is_stopped(instance); });
  }
  std::string expect_cancelled(const RequestId& id) {
    const Reply reply = final_reply(id);
    EXPECT_EQ(reply.state, ReplyState::kCancelled) << reply.why.sentence;
    EXPECT_EQ(reply.why.reason, Reason::kCancelled) << reply.why.sentence;
    return reply.why.sentence;
  }
};

// The standby hears the cancel alone, and the request comes when it has taken over.
TEST_F(CancelledTest, BeforeTheRequestHasReachedWhoTakesOver) {
  start_both();
  const Instance executor = start_executor();
  settle();
  const Order late = to_be_executed();
  stop(*a_);
  cancel(late.id, "arm");
  wait_until([&] { return epoch("b") > 0; });
  a_->send(SIGKILL);
  send(late);
  expect_cancelled(late.id);
  EXPECT_EQ(heard_["b"].solving, 0u);
  EXPECT_EQ(count(executor->output(), "executing id="), 0u) << executor->output();
}

// The owner has the request and cannot have heard the cancel: the standby, which knows nothing else of it, passes it
// on.
TEST_F(CancelledTest, WhereTheOwnerCannotHaveHeard) {
  a_ = start("a");
  connect();
  wait_until([&] { return owner() == "a"; });
  const Order slow = order(kSlow + "search: thorough\n");
  send(slow);
  wait_until_solving("a");
  b_ = start("b");
  wait_until([&] { return heard_.contains("b"); });
  settle();
  stop(*a_);
  Process passing({FJR_FIRST_REQUESTS, domain(), "cancel", to_text(slow.id)}, path("passing"));  // gone before it wakes
  EXPECT_EQ(passing.wait(), 0);
  a_->send(SIGCONT);
  EXPECT_EQ(expect_cancelled(slow.id), "cancelled while it was solved");
}

// Who takes over has many cancels to answer, a few in each turn, and is ended in the middle of that.
TEST_F(CancelledTest, WhenTheServiceEndsBeforeItHasAnsweredThemAll) {
  constexpr int kCancelled = 60;  // with the owner stopped the client's writer has room for about 100 requests
  start_both();
  listen_for(2);  // nobody waits for an executor any more
  stop(*a_);
  std::vector<RequestId> cancelled;
  for (int i = 0; i < kCancelled; ++i) {
    const Order one = order(kSlow);
    send(one);
    cancel(one.id, "arm");
    cancelled.push_back(one.id);
    std::this_thread::sleep_for(milliseconds(1));  // the writer of cancels keeps the last 16 for who is slow
  }
  wait_until([&] { return epoch("b") > 0; });
  b_->send(SIGTERM);
  a_->send(SIGKILL);
  for (const RequestId& id : cancelled) expect_cancelled(id);
}

TEST_F(StandbyTest, AnEndingOwnerHandsOver) {
  start_both();
  const Order one = order(kMedium), two = order(kFast);
  send(one);
  send(two);
  wait_until_solving("a");
  const auto ended = Clock::now();
  a_->send(SIGTERM);
  EXPECT_EQ(a_->wait(), 0);
  EXPECT_LT(seconds_since(ended), 1.0);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  EXPECT_EQ(final_reply(two.id).state, ReplyState::kSolved);
}

// More than its writer keeps for who is slow, to a standby that has heard none of them itself.
TEST_F(StandbyTest, AnEndingOwnerHandsOverWhateverWaits) {
  constexpr std::uint32_t kWaiting = 600;
  write("a.yaml", "{instance: a, queue: 700}\n");
  a_ = start_fjr({"serve", "--config", path("a.yaml"), "--domain", domain()}, "a");
  connect();
  for (std::uint32_t i = 0; i < kWaiting; ++i) {
    send(order(kSlow));
    if (i % 100 == 99) {
      wait_until([&] { return heard_["a"].queued + heard_["a"].solving == i + 1; });
    }
  }
  write("b.yaml", "{instance: b, queue: 700}\n");
  b_ = start_fjr({"serve", "--config", path("b.yaml"), "--domain", domain()}, "b");
  wait_until([&] { return heard_.contains("b"); });
  settle();
  b_->send(SIGSTOP);  // for less than its lease
  a_->send(SIGTERM);
  std::this_thread::sleep_for(milliseconds(100));
  b_->send(SIGCONT);
  EXPECT_EQ(a_->wait(), 0);
  wait_until([&] { return epoch("b") > 0 && heard_["b"].queued + heard_["b"].solving == kWaiting; });
  EXPECT_EQ(heard_["b"].queued + heard_["b"].solving, kWaiting);
}

TEST_F(StandbyTest, WhoIsAnsweredByOneIsNotAnsweredByTheOther) {
  start_both();
  const Order one = order(kFast);
  send(one);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  settle();
  EXPECT_EQ(heard_["a"].solved, 1u);
  EXPECT_EQ(heard_["b"].received, 0u);
  // The standby has heard the reply: taking over, it does not solve it again but repeats it.
  a_->send(SIGKILL);
  wait_until([&] { return epoch("b") > 0; });
  send(one);
  EXPECT_EQ(final_reply(one.id, 1).state, ReplyState::kSolved);
  EXPECT_EQ(heard_["b"].solved, 0u);
}

// Longer than the lease: it first makes sure that nobody has taken its place.
TEST_F(StandbyTest, AnAbsentOwnerAnswersWhatItMissed) {
  a_ = start("a");
  connect();
  wait_until([&] { return owner() == "a"; });
  a_->send(SIGSTOP);
  const Order one = order(kFast);
  send(one);
  std::this_thread::sleep_for(milliseconds(800));
  a_->send(SIGCONT);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  EXPECT_THAT(a_->output(), HasSubstr("absent for"));
  EXPECT_EQ(epoch("a"), 1u);
}

TEST_F(StandbyTest, AnInstanceWithAnotherRobotDoesNotServeTheSame) {
  a_ = start("a");
  connect();
  wait_until([&] { return owner() == "a"; });
  std::string robot = contents(default_robot_file());
  robot.replace(robot.find("mass: {value: [1.570"), 20, "mass: {value: [1.571");
  write("other_robot.yaml", robot);
  write("b.yaml", "{instance: b, robot: other_robot.yaml}\n");
  Process other = fjr({"serve", "--config", path("b.yaml"), "--domain", domain()}, "other");
  EXPECT_EQ(other.wait(), 2);
  EXPECT_THAT(other.output(), HasSubstr("other_robot.yaml: robot_id arm is served by instance a with another robot"));
  settle();
  EXPECT_EQ(epoch("a"), 1u);
}

TEST_F(StandbyTest, ASecondInstanceOfTheSameNameDoesNotStart) {
  a_ = start("a");
  connect();
  wait_until([&] { return owner() == "a"; });
  Process second = fjr({"serve", "--config", path("a.yaml"), "--domain", domain()}, "second");
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.output(), HasSubstr("another service is running as instance a"));
}

// Alone: the client asks again, the restarted service solves again, the executor knows the id.
TEST_F(StandbyTest, AfterKillAndRestartTheTrajectoryRunsOnce) {
  a_ = start("a");
  connect();
  const Instance executor = start_executor();
  write("medium.yaml", kMedium);
  Process request = fjr({"request", path("medium.yaml"), "--execute", "--domain", domain()}, "request.log");
  wait_until_solving("a");
  a_->send(SIGKILL);
  EXPECT_EQ(a_->wait(), -1);
  heard_.clear();
  b_ = start("b");
  EXPECT_EQ(request.wait(), 0) << request.output();
  wait_until_executed(*executor);
}

// Killed after it has published, so that the client never hears the reply.
TEST_F(StandbyTest, AfterKillBetweenExecutionAndReplyTheTrajectoryRunsOnce) {
  a_ = start("a");
  connect();
  const Instance executor = start_executor();
  settle();
  const Order one = to_be_executed();
  send(one);
  wait_until_executed(*executor);
  a_->send(SIGKILL);
  EXPECT_EQ(a_->wait(), -1);
  b_ = start("b");
  wait_until([&] { return epoch("b") > 0; });
  EXPECT_GT(epoch("b"), 1u);  // above what the executor has seen
  (void)final_reply(one.id);
  settle();
  send(one);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  settle();
  EXPECT_EQ(count(executor->output(), "executing id="), 1u) << executor->output();
  EXPECT_THAT(b_->output(), HasSubstr("published before id="));
}

}  // namespace
}  // namespace fjr
