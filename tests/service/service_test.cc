// The planning service as its clients see it: real processes, real DDS over the loopback interface.
#include <limits>

#include "planner/service/dds/wire_request.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

TEST_F(ServiceTest, GivesTheSameFilesAsPlanningByOneself) {
  serve();
  write("fast.yaml", kFast);
  Process request = fjr({"request", path("fast.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  EXPECT_EQ(request.wait(), 0) << request.output();
  Process plan = fjr({"plan", path("fast.yaml"), "--out", path("b")}, "plan.log");
  EXPECT_EQ(plan.wait(), 0) << plan.output();
  EXPECT_NE(contents(path("a/trajectory.csv")), "");
  EXPECT_EQ(contents(path("a/trajectory.csv")), contents(path("b/trajectory.csv")));
  EXPECT_THAT(contents(path("a/plan.json")), HasSubstr("\"verdict\": \"certified\""));
}

TEST_F(ServiceTest, SolvesTheSameIdOnce) {
  serve();
  const Order one = order(kFast);
  for (int i = 0; i < 3; ++i) send(one);
  const Reply first = final_reply(one.id);
  EXPECT_EQ(first.state, ReplyState::kSolved);
  EXPECT_GT(first.rows.size(), 100u);
  for (int i = 0; i < 2; ++i) {
    const auto asked = Clock::now();
    send(one);
    const Reply again = final_reply(one.id);
    EXPECT_LT(seconds_since(asked), 0.5);
    EXPECT_EQ(again.plan_json, first.plan_json);
    EXPECT_EQ(again.rows.size(), first.rows.size());
  }
  const ServiceStatus status = status_when([](const ServiceStatus& s) { return s.duplicates == 4; });
  EXPECT_EQ(status.received, 1u);
  EXPECT_EQ(status.solved, 1u);
}

TEST_F(ServiceTest, CancelsWhatIsBeingSolvedAndAnswersCancellingTwice) {
  serve();
  const Order slow = order(kSlow);
  send(slow);
  wait_until_solving();
  const auto asked = Clock::now();
  cancel(slow.id);
  EXPECT_EQ(final_reply(slow.id).state, ReplyState::kCancelled);
  RecordProperty("cancel_ms", static_cast<int>(1000 * seconds_since(asked)));
  EXPECT_LT(seconds_since(asked), 0.5);
  cancel(slow.id);
  EXPECT_EQ(final_reply(slow.id).state, ReplyState::kCancelled);
  const Order fast = order(kFast);
  send(fast);
  EXPECT_EQ(final_reply(fast.id).state, ReplyState::kSolved);
}

TEST_F(ServiceTest, CancelsWhatWaitsAndWhatHasNotArrived) {
  serve();
  const Order slow = order(kSlow), waiting = order(kSlow), late = order(kSlow);
  send(slow);
  send(waiting);
  cancel(late.id);
  EXPECT_EQ(final_reply(late.id).state, ReplyState::kCancelled);
  expect_accepted(waiting.id);
  cancel(waiting.id);
  EXPECT_EQ(final_reply(waiting.id).state, ReplyState::kCancelled);
  send(late);
  EXPECT_EQ(final_reply(late.id).state, ReplyState::kCancelled);
}

TEST_F(ServiceTest, KeepsToTheBudget) {
  serve();
  Order slow = order(kSlow), waiting = order(kSlow);
  slow.budget = 0.4;
  waiting.budget = 0.3;
  const auto asked = Clock::now();
  send(slow);
  send(waiting);
  EXPECT_EQ(final_reply(waiting.id).state, ReplyState::kExpired);
  const Reply reply = final_reply(slow.id);
  EXPECT_EQ(reply.state, ReplyState::kExpired);
  EXPECT_EQ(reply.why.reason, Reason::kBudget);
  EXPECT_GE(seconds_since(asked), 0.3);
  EXPECT_LT(seconds_since(asked), 1.0);
}

TEST_F(ServiceTest, SurvivesTheDeathOfAWorker) {
  serve();
  const Order slow = order(kSlow);
  send(slow);
  wait_until_solving();
  for (const pid_t worker : service().children()) ::kill(worker, SIGKILL);
  const Reply reply = final_reply(slow.id);
  EXPECT_EQ(reply.state, ReplyState::kFailed);
  EXPECT_EQ(reply.why.reason, Reason::kWorkerLost);
  const Order fast = order(kFast);
  send(fast);
  EXPECT_EQ(final_reply(fast.id).state, ReplyState::kSolved);
  status_when([](const ServiceStatus& status) { return status.workers_lost == 1; });
}

TEST_F(ServiceTest, AnswersWhatIsInFlightWhenItEnds) {
  serve();
  const Order slow = order(kSlow), waiting = order(kSlow);
  send(slow);
  send(waiting);
  wait_until_solving();
  const auto asked = Clock::now();
  service().send(SIGTERM);
  for (const RequestId& id : {slow.id, waiting.id}) {
    const Reply reply = final_reply(id, 2);
    EXPECT_EQ(reply.state, ReplyState::kCancelled);
    EXPECT_EQ(reply.why.reason, Reason::kShuttingDown);
  }
  EXPECT_EQ(service().wait(), 0);
  EXPECT_LT(seconds_since(asked), 1.0);
}

TEST_F(ServiceTest, LeavesNoWorkerBehindWhenItIsKilled) {
  serve();
  const Order slow = order(kSlow);
  send(slow);
  wait_until_solving();
  const std::vector<pid_t> workers = service().children();
  ASSERT_EQ(workers.size(), 1u);
  service().send(SIGKILL);
  EXPECT_EQ(service().wait(), -1);
  const auto gone = [&] { return contents("/proc/" + std::to_string(workers[0]) + "/comm").empty(); };
  for (const auto began = Clock::now(); !gone() && seconds_since(began) < 5;) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_TRUE(gone());
}

TEST_F(ServiceTest, RefusesWhatDoesNotFitTheQueue) {
  serve("{workers: 1, queue: 2}\n");
  std::vector<Order> orders;
  orders.push_back(order(kSlow));
  send(orders.back());
  wait_until_solving();
  for (int i = 0; i < 4; ++i) {
    orders.push_back(order(kSlow));
    send(orders.back());
  }
  for (const std::size_t refused : {3, 4}) {
    const Reply reply = final_reply(orders[refused].id);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    EXPECT_EQ(reply.why.reason, Reason::kQueueFull);
  }
}

TEST_F(ServiceTest, RefusesByName) {
  serve();
  const auto refusal = [&](const Order& bad) {
    send(bad);
    const Reply reply = final_reply(bad.id);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    return reply.why.field + ": " + reply.why.sentence;
  };
  EXPECT_EQ(refusal(order("start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n")), "goal.q[1]: 3.4 rad is outside [-2.6, 2.6]");
  EXPECT_THAT(refusal(order(kFast + "payload: {mass: 1}\n")), HasSubstr("payload: not supported by this version"));
  Order other_robot = order(kFast);
  other_robot.robot_hash = "0123";
  EXPECT_THAT(refusal(other_robot), HasSubstr("robot: the service plans for the robot with hash"));
  Order long_budget = order(kFast);
  long_budget.budget = 1e6;
  EXPECT_THAT(refusal(long_budget), HasSubstr("budget: 1000000 s is above 600 s"));
}

// DDS carries any number.
TEST_F(ServiceTest, RefusesWhatIsNotANumberByName) {
  serve();
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_PlanRequest> writer(participant, participant.handle());
  while (!writer.has_reader()) std::this_thread::sleep_for(milliseconds(5));
  const Order bad = order(kFast);
  dds::WireRequest wire = dds::encode(bad);
  wire.message.goal.q[1] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(writer.write(wire.message));
  const Reply reply = final_reply(bad.id);
  EXPECT_EQ(reply.state, ReplyState::kRejected);
  EXPECT_EQ(reply.why.field, "goal.q[1]");
  EXPECT_EQ(reply.why.sentence, "nan is not finite");
}

TEST_F(ServiceTest, ClientSaysWhenNobodyServes) {
  write("fast.yaml", kFast);
  Process request = fjr({"request", path("fast.yaml"), "--domain", domain(), "--find", "0.3"}, "request.log");
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("nobody serves plan requests on DDS domain " + domain()));
}

TEST_F(ServiceTest, ClientSaysWhenTheServiceIsSilent) {
  serve();
  write("slow.yaml", kSlow);
  Process request = fjr({"request", path("slow.yaml"), "--domain", domain(), "--silence", "1"}, "request.log");
  wait_until_solving();
  service().send(SIGSTOP);
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("has not answered for 1 s"));
}

TEST_F(ServiceTest, ClientCancelsWhenInterrupted) {
  serve();
  write("slow.yaml", kSlow);
  Process request = fjr({"request", path("slow.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  wait_until_solving();
  request.send(SIGINT);
  EXPECT_EQ(request.wait(), 5) << request.output();
  EXPECT_THAT(contents(path("a/plan.json")), HasSubstr("\"status\": \"cancelled\""));
  EXPECT_FALSE(fs::exists(path("a/trajectory.csv")));
}

TEST_F(ServiceTest, TellsHowItIsDoing) {
  serve();
  const Order fast = order(kFast);
  send(fast);
  EXPECT_EQ(final_reply(fast.id).state, ReplyState::kSolved);
  Process status = fjr({"status", "--domain", domain(), "--json"}, "status.log");
  EXPECT_EQ(status.wait(), 0);
  EXPECT_THAT(status.output(), HasSubstr("\"solved\": 1"));
}

// Each waits for its turn, all are answered.
TEST_F(ServiceTest, ServesManyClientsAtOnce) {
  serve();
  write("bad.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
  write("fast.yaml", kFast);
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < 30; ++i) {
    const std::string file = path(i % 10 == 0 ? "fast.yaml" : "bad.yaml").string();
    clients.push_back(std::make_unique<Process>(
        std::vector<std::string>{FJR_EXECUTABLE, "request", file, "--domain", domain()}, path(std::to_string(i))));
  }
  for (std::size_t i = 0; i < clients.size(); ++i) {
    EXPECT_EQ(clients[i]->wait(), i % 10 == 0 ? 0 : 2) << clients[i]->output();
  }
}

// A client that keeps asking meets the service again.
TEST_F(ServiceTest, ClientOutlivesTheService) {
  serve();
  write("slow.yaml", kSlow);
  write("fast.yaml", kFast);
  Process request = fjr({"request", path("fast.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  wait_until_solving();
  service().send(SIGKILL);
  EXPECT_EQ(service().wait(), -1);
  serve();
  EXPECT_EQ(request.wait(), 0) << request.output();
  EXPECT_TRUE(fs::exists(path("a/trajectory.csv")));
}

TEST_F(ServiceTest, ClientPassesOnTheRefusal) {
  serve();
  write("bad.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
  Process request = fjr({"request", path("bad.yaml"), "--domain", domain()}, "request.log");
  EXPECT_EQ(request.wait(), 2);
  EXPECT_THAT(request.output(), HasSubstr("goal.q[1]: 3.4 rad is outside [-2.6, 2.6]"));
}

}  // namespace
}  // namespace fjr
