// Requests that have to do with the executor: executing what was planned before, starting where the arm rests, telling
// ROS 2.
#include <cmath>

#include "model/dynamics.h"
#include "planner/dds/joint_trajectory.h"
#include "planner/dds/reader.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

const std::string kBack = "start: {q: [0.42, 0.08]}\ngoal: {q: [0.3, 0.2]}\nobjective: fastest\n";
const std::string kToBack = "goal: {q: [0.3, 0.2]}\nobjective: fastest\n";  // from wherever the arm rests

class ExecuteTest : public ServiceTest {
 protected:
  void start_executor(const std::string& at = "0.3,0.2", const std::vector<std::string>& more = {"--fast"}) {
    executor_ = ServiceTest::start_executor(at, more);
  }
  Process& executor() { return *executor_; }
  void wait_for(const std::string& in_log) { EXPECT_TRUE(says(executor(), in_log)) << executor().output(); }

  Order execution_of(const RequestId& planned) {
    Order execute = order("");
    execute.action = Action::kExecute;
    execute.trajectory_id = planned;
    return execute;
  }
  Reply answer_to(const Order& order) {
    send(order);
    return final_reply(order.id);
  }
  Reply expect_refused(const Order& order, const std::string& field, const std::string& sentence) {
    const Reply reply = answer_to(order);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    EXPECT_EQ(reply.why.field, field);
    EXPECT_THAT(reply.why.sentence, HasSubstr(sentence));
    return reply;
  }

  std::unique_ptr<Process> executor_;
};

TEST_F(ExecuteTest, WhatWasPlannedBeforeIsExecutedByItsId) {
  serve();
  start_executor();
  const Order plan = order(kFast);
  const Reply planned = answer_to(plan);
  ASSERT_EQ(planned.state, ReplyState::kSolved);
  const Order execute = execution_of(plan.id);
  const Reply reply = answer_to(execute);
  EXPECT_EQ(reply.state, ReplyState::kSolved);
  EXPECT_EQ(reply.rows.size(), planned.rows.size());
  wait_for("finished id=" + text(execute.id) + " code=0");
  EXPECT_THAT(executor().output(), HasSubstr("stops_came=1"));
  // The same id again is the same execution, which is over.
  EXPECT_EQ(answer_to(execute).state, ReplyState::kSolved);
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("refused")));
}

// 0.5 g at the tip that nobody planned with: what the encoders read tells them, far within all tolerances.
TEST_F(ExecuteTest, AnArmThatIsNotAsItsRobotFileSaysIsTold) {
  serve();
  start_executor("0.3,0.2", {"--fast", "--payload", "0.0005"});
  Order execute = order(kFast);
  execute.action = Action::kPlanAndExecute;
  ASSERT_EQ(answer_to(execute).state, ReplyState::kSolved);
  wait_for("finished id=" + text(execute.id) + " code=0");
  const std::string told = "drifts from robot.yaml since " + text(execute.id) + " (1 of 1 motion): ";
  wait_until([&] { return count(service().output(), "arm of robot=arm " + told) > 0; }, 60);
  EXPECT_THAT(executor().output(), HasSubstr("arm " + told));
  Process status = fjr({"status", "--json", "--domain", domain()}, "status");
  EXPECT_EQ(status.wait(), 0);
  EXPECT_THAT(status.output(), HasSubstr("\"drifts\": true"));
  Process people = fjr({"status", "--domain", domain()}, "people");
  EXPECT_EQ(people.wait(), 0);
  EXPECT_THAT(people.output(), HasSubstr("arm of arm: " + told));
}

// A standby passes on what it has heard, late: what was refused for the moment is not done then, behind its client's
// back.
TEST_F(ExecuteTest, ACopyOfWhatWasRefusedForTheMomentDoesNotMoveTheArm) {
  serve();
  start_executor();
  wait_for_executor();
  settle();
  const Order plan = order(kFast), execute = execution_of(plan.id);
  expect_refused(execute, "trajectory_id", "not among the requests this service has planned lately");
  ASSERT_EQ(answer_to(plan).state, ReplyState::kSolved);
  const dds::Participant standby(domain_);
  dds::Writer<fjr_msg_RelayedRequest> relayed(standby, standby.handle());
  while (!relayed.has_reader()) listen();
  EXPECT_TRUE(relayed.write(dds::encode(dds::Relayed{execute, 0, false})));
  EXPECT_TRUE(relayed.flush(DDS_SECS(5)));
  listen_for(1);
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("executing id=")));
  EXPECT_EQ(answer_to(execute).state, ReplyState::kSolved);  // its client asks again
  wait_for("executing id=" + text(execute.id));
}

TEST_F(ExecuteTest, WhatCannotBeExecutedIsRefusedByName) {
  serve();
  RequestId unknown = me_;
  unknown.number = 12345;
  expect_refused(execution_of(unknown), "trajectory_id", "not among the requests this service has planned lately");
  const Order slow = order(kSlow);
  send(slow);
  expect_refused(execution_of(slow.id), "trajectory_id", "is still being planned");
  cancel(slow.id);
  EXPECT_EQ(final_reply(slow.id).state, ReplyState::kCancelled);
  expect_refused(execution_of(slow.id), "trajectory_id", "ended as CANCELLED");
  const Order moving = order("start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08], dq: [0.1, 0.1]}\nobjective: fastest\n");
  EXPECT_EQ(answer_to(moving).state, ReplyState::kSolved);
  expect_refused(execution_of(moving.id), "trajectory_id", "does not go from rest to rest");
}

// Refusals, and cancellations of what nobody has asked for, cost no planned trajectory.
TEST_F(ExecuteTest, WhatWasPlannedIsKeptWhateverIsRefused) {
  serve();
  start_executor();
  const Order planned = order(kFast);
  EXPECT_EQ(answer_to(planned).state, ReplyState::kSolved);
  for (int i = 0; i < 300; ++i) {
    Order bad = order("start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
    send(bad);
    bad.id.client[0] ^= static_cast<std::uint8_t>(1 + i % 7);
    cancel(bad.id);
    if (i % 50 != 49) continue;
    EXPECT_EQ(final_reply(order_sent_last()).state, ReplyState::kRejected);
  }
  EXPECT_EQ(answer_to(execution_of(planned.id)).state, ReplyState::kSolved);
  wait_for("finished id=");
}

TEST_F(ExecuteTest, TheFolderOfAnEarlierRequestIsExecuted) {
  serve();
  start_executor();
  write("fast.yaml", kFast);
  Process plan = fjr({"request", path("fast.yaml"), "--out", path("a"), "--domain", domain()}, "plan");
  EXPECT_EQ(plan.wait(), 0) << plan.output();
  Process late =
      fjr({"request", path("fast.yaml"), "--out", path("a"), "--budget", "1e-6", "--domain", domain()}, "late");
  EXPECT_EQ(late.wait(), 5);
  EXPECT_THAT(late.output(), HasSubstr("the earlier certified plan is in " + path("a/previous").string()));
  Process failed = fjr({"request", path("a"), "--execute", "--domain", domain()}, "failed");
  EXPECT_EQ(failed.wait(), 2);  // what failed is not executed, nor what it has replaced by mistake
  EXPECT_THAT(failed.output(), HasSubstr("that of the earlier plan is in " + path("a/previous").string()));
  Process execute = fjr({"request", path("a/previous"), "--execute", "--domain", domain()}, "execute");
  EXPECT_EQ(execute.wait(), 0) << execute.output();
  EXPECT_THAT(execute.output(), HasSubstr("code 0 SUCCESSFUL"));
  Process again = fjr({"request", path("a/previous"), "--execute", "--json", "--domain", domain()}, "again");
  EXPECT_EQ(again.wait(), 1);  // the arm is where the motion ended
  EXPECT_THAT(again.output(),
              HasSubstr("\"execution\": {\n    \"result\": \"INVALID_GOAL\",\n    \"reason\": \"starts at"));
  Process plain = fjr({"request", path("a"), "--domain", domain()}, "plain");
  EXPECT_EQ(plain.wait(), 2);
  EXPECT_THAT(plain.output(), HasSubstr("is a folder"));
  fs::create_directories(path("empty"));
  Process empty = fjr({"request", path("empty"), "--execute", "--domain", domain()}, "empty_log");
  EXPECT_EQ(empty.wait(), 2);
  EXPECT_THAT(empty.output(), HasSubstr("has no trajectory.id"));
}

// An executor that has refused a trajectory does not move: nobody has to wait until it would have begun, which is told
// for a second. The service may hear of it a moment after its log has it.
TEST_F(ExecuteTest, AfterARefusedTrajectoryTheArmRestsAsBefore) {
  serve();
  start_executor();
  wait_for_executor();
  settle();
  Order from_elsewhere = order(kBack);
  from_elsewhere.action = Action::kPlanAndExecute;
  EXPECT_EQ(answer_to(from_elsewhere).state, ReplyState::kSolved);
  wait_for("refused id=" + text(from_elsewhere.id));
  const auto soon = std::chrono::steady_clock::now() + milliseconds(800);
  Reply next = answer_to(order("goal: {q: [0.42, 0.08]}\nobjective: fastest\n"));
  while (next.why.reason == Reason::kArmNotAtRest && std::chrono::steady_clock::now() < soon) {
    next = answer_to(order("goal: {q: [0.42, 0.08]}\nobjective: fastest\n"));
  }
  EXPECT_EQ(next.state, ReplyState::kSolved) << next.why.sentence;
}

// Whoever asks again for a motion, of which the executor alone knows any more, hears how it ended, and nothing moves.
TEST_F(ExecuteTest, AMotionAskedForAgainAfterBothHaveStartedAnewIsReported) {
  serve();
  start_executor();
  wait_for_executor();
  settle();
  Order there = order(kFast);
  there.action = Action::kPlanAndExecute;
  ASSERT_EQ(answer_to(there).state, ReplyState::kSolved);
  ASSERT_TRUE(result_of(there.id));
  for (Process* ended : {&service(), &executor()}) {
    ended->send(SIGTERM);
    EXPECT_EQ(ended->wait(), 0);
  }
  start_executor("0.42,0.08");
  serve();
  wait_for_executor();
  settle();
  send(there);
  EXPECT_EQ(final_reply(there.id).state, ReplyState::kSolved);
  const auto result = result_of(there.id);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->code, ResultCode::kSuccessful) << result->sentence;
  settle();
  EXPECT_THAT(executor().output(), testing::Not(HasSubstr("executing id=")));
}

// What it is about to run is on the disk before it runs, and how it ended as well: first the file, then its name.
TEST_F(ExecuteTest, TheExecutorsMemoryIsOnTheDisk) {
  serve();
  executor_ = std::make_unique<Process>(
      std::vector<std::string>{"/usr/bin/env", "LD_PRELOAD=" FJR_RECORDED_FILES,
                               "FJR_RECORDED_FILES=" + path("files").string(), FJR_EXECUTABLE, "executor", "--start",
                               "0.3,0.2", "--state", path("state"), "--fast", "--domain", domain()},
      path("executor"));
  wait_for_executor();
  settle();
  Order there = order(kFast);
  there.action = Action::kPlanAndExecute;
  ASSERT_EQ(answer_to(there).state, ReplyState::kSolved);
  wait_for("executing id=");
  const std::string file = path("state") / ("executor-" + domain() + "-arm"), temporary = "[^ ]*/state/[.][^ ]*[.]tmp";
  const std::string written =
      "fsync (" + temporary + ")\nrename " + temporary + " " + file + "\nfsync " + path("state").string() + "\n";
  EXPECT_THAT(contents(path("files")), testing::StartsWith("fsync "));
  EXPECT_THAT(contents(path("files")), testing::ContainsRegex(written));
  ASSERT_TRUE(result_of(there.id));
  EXPECT_THAT(contents(path("files")), testing::MatchesRegex("(" + written + ")(" + written + ")"));
}

TEST_F(ExecuteTest, WithoutAnExecutorTheStartIsAskedFor) {
  serve();
  expect_refused(order(kToBack), "start", "no executor of robot arm says where the arm is");
  start_executor();
  wait_for_executor();
  settle();
  Order plan = order(kToBack);
  plan.document = "goal: {q: [0.42, 0.08]}\n";
  EXPECT_EQ(answer_to(plan).state, ReplyState::kSolved);
  executor().send(SIGSTOP);
  std::this_thread::sleep_for(milliseconds(700));  // a state counts for half a second
  const Reply stale = answer_to(order(kToBack));
  EXPECT_EQ(stale.state, ReplyState::kRejected);
  EXPECT_EQ(stale.why.field, "start");
  EXPECT_EQ(stale.why.reason, Reason::kArmNotAtRest);
}

// The plan is certified whether or not anybody tells what became of its execution.
TEST_F(ExecuteTest, APlanIsKeptWhereNoExecutorReports) {
  serve();
  write("fast.yaml", kFast);
  Process unheard = fjr(
      {"request", path("fast.yaml"), "--execute", "--out", path("a"), "--find", "1", "--domain", domain()}, "unheard");
  EXPECT_EQ(unheard.wait(), 1);
  EXPECT_THAT(unheard.output(), HasSubstr("the trajectory was published, but there is no executor"));
  EXPECT_THAT(unheard.output(), HasSubstr("files       " + path("a/trajectory.csv").string()));
  for (const char* file : {"trajectory.csv", "trajectory.id", "plan.json"}) EXPECT_TRUE(fs::exists(path("a") / file));
}

// Who starts service, executor and client at the same time is not told that there is no executor.
TEST_F(ExecuteTest, WhoAsksBeforeTheExecutorIsThereIsAnsweredOnceItIs) {
  serve();
  const Order plan = order("goal: {q: [0.42, 0.08]}\nobjective: fastest\n");
  const Order cancelled = order(plan.document);
  send(plan);
  send(cancelled);
  std::this_thread::sleep_for(milliseconds(300));
  cancel(cancelled.id);
  start_executor();
  const Reply reply = final_reply(plan.id);
  EXPECT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
  EXPECT_EQ(final_reply(cancelled.id).state, ReplyState::kCancelled);
}

// What no executor can change is refused at once: before any was met, which is looked for during the first 2 s.
TEST_F(ExecuteTest, WhatIsRefusedAnywayDoesNotWaitForTheExecutor) {
  serve();
  Order waits = order(kToBack), elsewhere = order(kFast),
        outside = order("start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
  elsewhere.action = outside.action = Action::kPlanAndExecute;
  elsewhere.robot_id = "another";
  for (const Order& sent : {waits, order("goal: {q: [0.1, 0.1], typo: 1}\n"), elsewhere, outside}) send(sent);
  std::vector<RequestId> refused;
  while (refused.size() < 4) {
    const auto reply = next_final();
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->state, ReplyState::kRejected);
    refused.push_back(reply->id);
  }
  EXPECT_EQ(refused.back(), waits.id);  // there is no executor
}

// Whoever finds no place among those who wait for the executor hears so.
TEST_F(ExecuteTest, MoreThanCanWaitForTheExecutorAreRefused) {
  constexpr std::size_t kWaiting = 1024, kMore = 100;
  serve();
  for (std::size_t i = 0; i < kWaiting + kMore; ++i) send(order(kToBack));
  std::size_t full = 0, others = 0;
  while (full + others < kWaiting + kMore) {
    const auto reply = next_final();
    ASSERT_TRUE(reply) << full << " " << others;
    EXPECT_EQ(reply->state, ReplyState::kRejected);
    ++(reply->why.reason == Reason::kQueueFull ? full : others);
  }
  EXPECT_EQ(full, kMore);  // no executor has come for the others
}

TEST_F(ExecuteTest, WhoWaitsForTheExecutorIsAnsweredWhenTheServiceEnds) {
  serve();
  const Order plan = order(kToBack);
  send(plan);
  std::this_thread::sleep_for(milliseconds(300));
  service().send(SIGTERM);
  EXPECT_EQ(final_reply(plan.id, 5).why.reason, Reason::kShuttingDown);
}

TEST_F(ExecuteTest, PlanningAloneNeedsAStart) {
  write("nowhere.yaml", kToBack);
  Process plan = fjr({"plan", path("nowhere.yaml"), "--out", path("a")}, "plan");
  EXPECT_EQ(plan.wait(), 2);
  EXPECT_THAT(plan.output(), HasSubstr("start: missing; only a request to the service may leave it out"));
}

// What a ROS 2 subscription asks for by default: reliable, volatile, the last 10.
TEST_F(ExecuteTest, Ros2SeesWhatIsExecuted) {
  EXPECT_STREQ(dds::TopicOf<dds::JointTrajectory>::descriptor()->m_typename,
               "trajectory_msgs::msg::dds_::JointTrajectory_");
  EXPECT_STREQ(dds::TopicOf<dds::JointTrajectory>::kName, "rt/joint_trajectory");
  serve("{ros2: {joint_trajectory: true, joint_names: [shoulder, elbow]}}\n");
  const dds::Participant participant(domain_);
  dds::Qos ros;
  ros.reliable(DDS_MSECS(100)).keep_last(10);
  dds::Reader<dds::JointTrajectory> reader(participant, participant.handle(), ros);
  const auto began = Clock::now();
  while (!reader.has_writer() && seconds_since(began) < 5) listen();
  Order there = order(kFast);
  there.action = Action::kPlanAndExecute;
  const Reply reply = answer_to(there);
  ASSERT_EQ(reply.state, ReplyState::kSolved);
  std::size_t messages = 0;
  while (messages == 0 && seconds_since(began) < 15) {
    reader.take_all([&](const dds::JointTrajectory& message, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      ++messages;
      EXPECT_STREQ(message.joint_names_._buffer[1], "elbow");
      ASSERT_EQ(message.points_._length, reply.rows.size());
      for (std::size_t i = 0; i < reply.rows.size(); ++i) {
        const auto& point = message.points_._buffer[i];
        const double time = point.time_from_start_.sec + 1e-9 * point.time_from_start_.nanosec;
        EXPECT_NEAR(time, reply.rows[i].time, 1e-9);  // whole nanoseconds
        ASSERT_EQ(point.positions_._length, 2u);
        EXPECT_EQ(point.positions_._buffer[1], reply.rows[i].state.q[1]);
        EXPECT_EQ(point.velocities_._buffer[0], reply.rows[i].state.dq[0]);
        EXPECT_EQ(point.effort_._buffer[1], reply.rows[i].torque[1]);
      }
      // Accelerations are those of the motion: the change of velocity over 10 ms, by the trapezoidal rule. Their own
      // change within a row is what the rule cannot see.
      double gained = 0;
      std::size_t last = 0;
      for (; reply.rows[last].time < 0.01; ++last) {
        const double step = reply.rows[last + 1].time - reply.rows[last].time;
        gained += 0.5 * step *
                  (message.points_._buffer[last].accelerations_._buffer[0] +
                   message.points_._buffer[last + 1].accelerations_._buffer[0]);
      }
      EXPECT_NEAR(gained, reply.rows[last].state.dq[0], 0.02 * std::abs(reply.rows[last].state.dq[0]) + 1e-6);
    });
    listen();
  }
  EXPECT_EQ(messages, 1u);
}

}  // namespace
}  // namespace fjr
