// A service whose requests are solved by workers of their own, `fjr serve --worker-only`: real processes over the
// loopback interface. machines_network_test.cc has them on machines and networks that fail.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "planner/dds/wire_work.h"
#include "planner/dds/worker_port.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

// Where nothing is to be solved each request takes so long and ends as FAILED.
const std::vector<std::string> kRehearsal = {"--rehearse", "0.3"};

class MachinesTest : public ServiceTest {
 protected:
  using Instance = std::unique_ptr<Process>;

  // One that solves nothing itself.
  void serve_by_others(const std::string& name = "owner") {
    owner_ = start_owner(name);
    connect();
  }
  Instance start_owner(const std::string& name) {
    write(name + ".yaml", "{workers: 0, warm_plans: 0, instance: " + name + "}\n");
    return start_fjr({"serve", "--config", path(name + ".yaml"), "--domain", domain()}, name + ".log");
  }
  Instance start_worker(const std::string& name, const std::vector<std::string>& more = {}, int slots = 1) {
    write(name + ".yaml", "{warm_plans: 0, instance: " + name + "}\n");
    std::vector<std::string> words = {"serve",    "--worker-only", "--config",  path(name + ".yaml"),
                                      "--domain", domain(),        "--workers", std::to_string(slots)};
    words.insert(words.end(), more.begin(), more.end());
    return start_fjr(words, name + ".log");
  }
  void wait_for_slots(std::uint32_t slots) {
    status_when([&](const ServiceStatus& status) { return status.epoch > 0 && status.workers == slots; }, 10);
  }
  void expect_answered_once(const std::vector<RequestId>& ids) {
    for (const RequestId& id : ids) EXPECT_EQ(final_reply(id).state, ReplyState::kFailed);
    listen();
    EXPECT_FALSE(next_final(0.3));
  }
  std::vector<RequestId> ask(int requests) {
    std::vector<RequestId> ids;
    for (int i = 0; i < requests; ++i) {
      const Order one = order(kFast);
      send(one);
      ids.push_back(one.id);
    }
    return ids;
  }

  Instance owner_;
};

nlohmann::json without_times(const Reply& reply) {
  nlohmann::json plan = nlohmann::json::parse(reply.plan_json);
  plan.erase("timing");
  return plan;
}

TEST_F(MachinesTest, AWorkersPlanIsTheOneThatIsPlannedHere) {
  serve_by_others();
  const Instance worker = start_worker("worker");
  wait_for_slots(1);
  const Order one = order(kFast);
  send(one);
  const Reply theirs = final_reply(one.id);
  ASSERT_EQ(theirs.state, ReplyState::kSolved) << theirs.why.sentence;
  EXPECT_TRUE(says(*worker, "leased by=owner"));

  write("request.yaml", kFast);
  const Instance plan = start_fjr({"plan", path("request.yaml"), "--out", path("out")}, "plan.log");
  ASSERT_EQ(plan->wait(), 0) << plan->output();
  nlohmann::json ours = nlohmann::json::parse(contents(path("out") / "plan.json"));
  ours.erase("timing");
  nlohmann::json answered = without_times(theirs);
  // The request's name alone is another: a file's on one side, the order's on the other.
  ours.erase("name");
  answered.erase("name");
  EXPECT_EQ(answered, ours);
}

TEST_F(MachinesTest, MotionsAreExecutedOnceWithTheirStops) {
  serve_by_others();
  const Instance worker = start_worker("worker");
  const Instance executor = start_executor();
  wait_for_executor();
  wait_for_slots(1);
  Order there = order(kFast);
  there.action = Action::kPlanAndExecute;
  send(there);
  EXPECT_EQ(final_reply(there.id).state, ReplyState::kSolved);
  ASSERT_TRUE(result_of(there.id));

  const Order back = order("start: {q: [0.42, 0.08]}\ngoal: {q: [0.3, 0.2]}\nobjective: fastest\n");
  send(back);
  EXPECT_EQ(final_reply(back.id).state, ReplyState::kSolved);
  Order execute = order("");
  execute.action = Action::kExecute;
  execute.trajectory_id = back.id;
  send(execute);
  EXPECT_EQ(final_reply(execute.id).state, ReplyState::kSolved);
  const auto result = result_of(execute.id);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->code, ResultCode::kSuccessful) << result->sentence;
  EXPECT_EQ(count(executor->output(), "executing id="), 2u) << executor->output();
  EXPECT_EQ(count(worker->output(), "leased by=owner"), 3u);
}

TEST_F(MachinesTest, WhatAKilledWorkerHadIsDoneByAnother) {
  serve_by_others();
  Instance first = start_worker("first", kRehearsal);
  wait_for_slots(1);
  const std::vector<RequestId> ids = ask(3);
  EXPECT_TRUE(says(*first, "leased by=owner"));
  first->send(SIGKILL);
  const Instance second = start_worker("second", kRehearsal);
  expect_answered_once(ids);
  EXPECT_EQ(count(owner_->output(), "finished id="), 3u) << owner_->output();
}

// It finishes what nobody waits for any more, and is told so.
TEST_F(MachinesTest, WhatAPausedWorkerBringsTooLateIsNotTaken) {
  serve_by_others();
  const Instance first = start_worker("first", kRehearsal);
  wait_for_slots(1);
  const std::vector<RequestId> ids = ask(1);
  EXPECT_TRUE(says(*first, "leased by=owner"));
  first->send(SIGSTOP);
  const Instance second = start_worker("second", kRehearsal);
  EXPECT_TRUE(says(*owner_, "worker silent name=first requests back in the queue: 1"));
  expect_answered_once(ids);
  first->send(SIGCONT);
  wait_for_slots(2);
  EXPECT_FALSE(next_final(0.5));
  EXPECT_EQ(count(owner_->output(), "finished id="), 1u) << owner_->output();
  expect_answered_once(ask(4));  // the first one works again
  EXPECT_GE(count(first->output(), "leased by=owner"), 2u);
}

TEST_F(MachinesTest, AWorkerThatEndsReturnsWhatItHas) {
  serve_by_others();
  const Instance first = start_worker("first", {"--rehearse", "30"});
  wait_for_slots(1);
  const std::vector<RequestId> ids = ask(1);
  EXPECT_TRUE(says(*first, "leased by=owner"));
  const Instance second = start_worker("second", kRehearsal);
  wait_for_slots(2);
  first->send(SIGTERM);
  EXPECT_EQ(first->wait(), 0);
  EXPECT_THAT(first->output(), HasSubstr("stopped returned=1"));
  expect_answered_once(ids);
}

TEST_F(MachinesTest, ASolvingProcessThatDiesCostsOneAttempt) {
  serve_by_others();
  const Instance worker = start_worker("worker", {"--rehearse", "1"});
  wait_for_slots(1);
  const Order one = order(kFast);
  send(one);
  for (std::size_t attempt = 1; attempt <= 2; ++attempt) {
    EXPECT_TRUE(says(*worker, "leased by=owner", attempt));
    for (const pid_t process : worker->children()) ::kill(process, SIGKILL);
  }
  const Reply reply = final_reply(one.id);
  EXPECT_EQ(reply.why.reason, Reason::kWorkerLost) << reply.why.sentence;
}

TEST_F(MachinesTest, ACancelledRequestLeavesItsWorker) {
  serve_by_others();
  const Instance worker = start_worker("worker", {"--rehearse", "30"});
  wait_for_slots(1);
  const std::vector<RequestId> ids = ask(2);
  EXPECT_TRUE(says(*worker, "leased by=owner"));
  cancel(ids[0]);
  EXPECT_EQ(final_reply(ids[0]).why.reason, Reason::kCancelled);
  EXPECT_TRUE(says(*worker, "leased by=owner", 2));  // the next one has its place
}

TEST_F(MachinesTest, WhatTheKilledOwnerHadLeasedIsDoneForItsStandby) {
  serve_by_others("a");
  const Instance worker = start_worker("worker", {"--rehearse", "1"});
  wait_for_slots(1);
  const Instance standby = start_owner("b");
  EXPECT_TRUE(says(*standby, "as standby"));
  settle();
  const std::vector<RequestId> ids = ask(2);
  EXPECT_TRUE(says(*worker, "leased by=a"));
  owner_->send(SIGKILL);
  expect_answered_once(ids);
  EXPECT_EQ(count(worker->output(), "leased by=b"), 2u) << worker->output();
}

TEST_F(MachinesTest, AWorkerWithAnotherRobotIsRefusedAndTold) {
  serve_by_others();
  std::string robot = contents(FJR_SOURCE_DIR "/config/robot.yaml");
  robot.replace(robot.find("20.48"), 5, "20.49");
  write("robot.yaml", robot);
  write("other.yaml", "{robot: robot.yaml, instance: other}\n");
  const Instance worker = start_fjr(
      {"serve", "--worker-only", "--config", path("other.yaml"), "--domain", domain(), "--rehearse", "1"}, "other.log");
  EXPECT_EQ(worker->wait(), 2) << worker->output();
  EXPECT_THAT(worker->output(), HasSubstr("robot_id arm is served by instance owner with another robot"));
  EXPECT_THAT(owner_->output(), HasSubstr("worker refused name=other"));
}

// What another version would say of itself.
TEST_F(MachinesTest, AWorkerOfAnotherVersionIsRefusedAndTold) {
  serve_by_others();
  status_when([](const ServiceStatus& status) { return status.epoch > 0; });
  const Instance status = start_fjr({"status", "--json", "--domain", domain()}, "status.log");
  EXPECT_EQ(status->wait(), 0);
  const nlohmann::json shown = nlohmann::json::parse(status->output());
  const RequestId self = new_client();
  dds::WorkerPort worker(dds::Participant(domain_), self.client);
  WorkerOffer offer;
  offer.worker = self.client;
  offer.instance = "older";
  offer.robot_id = "arm";
  offer.robot_hash = shown["services"][0]["robot_hash"];
  offer.version = "0.0.1";
  offer.slots = 4;
  (void)ask(1);
  std::vector<LeaseWord> words;
  for (const auto began = Clock::now(); words.empty() && seconds_since(began) < 5; words = worker.take_leases()) {
    worker.send(offer);
    worker.wait(milliseconds(100));
  }
  ASSERT_FALSE(words.empty());
  EXPECT_EQ(words[0].kind, LeaseKind::kRefused);
  EXPECT_EQ(words[0].refused, RefusedFor::kVersion);
  EXPECT_THAT(words[0].sentence, HasSubstr("this worker is fjr 0.0.1"));
  EXPECT_THAT(owner_->output(), HasSubstr("worker refused name=older"));
  wait_for_slots(0);
}

// What 4 + 2 slots can do at once takes as long as one request.
TEST_F(MachinesTest, AllSlotsOfAllMachinesAreUsed) {
  serve_by_others();
  const Instance first = start_worker("first", kRehearsal, 4), second = start_worker("second", kRehearsal, 2);
  wait_for_slots(6);
  expect_answered_once(ask(18));
  EXPECT_NEAR(static_cast<double>(count(first->output(), "leased by=owner")), 12, 2);
  EXPECT_NEAR(static_cast<double>(count(second->output(), "leased by=owner")), 6, 2);
}

}  // namespace
}  // namespace fjr
