// Motions that are repeated: the service corrects them by what the executor has told of their last run.
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "model/encoder.h"
#include "model/parameters.h"
#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

// They end where they begin, so that they can be repeated at once.
const std::string kLoop =
    "start: {q: [0, 0]}\nvia: [{q: [0.3, -0.2]}]\ngoal: {q: [0, 0]}\nduration: 0.8\nobjective: gentle\nsearch: quick\n";
const std::string kOtherLoop =
    "start: {q: [0, 0]}\nvia: [{q: [-0.2, 0.3]}]\ngoal: {q: [0, 0]}\nduration: 0.7\nobjective: gentle\nsearch: quick\n";
const std::vector<std::string> kFiveGrams{"--fast", "--payload", "0.005"};  // within all tolerances, and not the model

class RepeatTest : public ServiceTest {
 protected:
  void start_executor(const std::vector<std::string>& arm = kFiveGrams) {
    executor_ = ServiceTest::start_executor("0,0", arm);
    EXPECT_TRUE(says(*executor_, "executing for")) << executor_->output();
  }
  void stop_executor() {
    executor_->send(SIGTERM);
    EXPECT_EQ(executor_->wait(), 0);
  }
  // The arm of the issue of learning: springs 5 % softer, friction 20 % more viscous, 0.1 kg at its tip, hysteresis.
  std::vector<std::string> wrong_arm() const {
    std::string text = contents(default_robot_file());
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
    replace("[20.48, 17.75]", "[19.456, 16.8625]");
    replace("[0.4968, 0.5051]", "[0.59616, 0.60612]");
    write("wrong.yaml", text);
    write("executor.yaml", "tolerances: {path: [0.1, 0.1], goal: [0.03, 0.03], stopped_velocity: [0.5, 0.5]}\n");
    return {"--fast",    "--config", path("executor.yaml"), "--true-robot", path("wrong.yaml"),
            "--payload", "0.1",      "--hysteresis"};
  }

  Order motion(const std::string& yaml) {
    Order motion = order(yaml);
    motion.action = Action::kPlanAndExecute;
    return motion;
  }
  Order about(Action action, const RequestId& id) {
    Order about = order("");
    about.action = action;
    about.trajectory_id = id;
    return about;
  }
  // Asked again where nobody answers, and where it is refused for the moment: the arm does not rest yet, or the
  // executor is not met.
  Reply answer_to(const Order& order) {
    for (int i = 0; i < 50; ++i) {
      send(order);
      const auto reply = next_final(1);
      if (!reply || reply->id != order.id) continue;
      if (reply->why.reason != Reason::kArmNotAtRest) return *reply;
      listen_for(0.1);
    }
    ADD_FAILURE() << "no answer";
    return {};
  }
  struct Run {
    RequestId id;
    Reply reply;
    ExecutionResult result;
    int repetition = 1;       // by its plan.json
    double rms = 0;           // [counts] of both links
    nlohmann::json learnt{};  // what its plan.json says of it
  };
  Run run(const Order& order) {
    Run run{order.id, answer_to(order), {}};
    EXPECT_EQ(run.reply.state, ReplyState::kSolved) << run.reply.why.sentence;
    if (run.reply.state != ReplyState::kSolved) return run;
    run.result = result_of(order.id).value_or(ExecutionResult{});
    EXPECT_EQ(run.result.trajectory_id, order.id);
    EXPECT_EQ(run.result.code, ResultCode::kSuccessful) << run.result.sentence;
    const auto plan = nlohmann::json::parse(run.reply.plan_json);
    if (plan.contains("repetition")) run.learnt = plan.at("repetition");
    if (plan.contains("repetition")) run.repetition = run.learnt.at("number");
    run.rms = std::hypot(run.result.link_error_rms[0], run.result.link_error_rms[1]) /
              count_angle(load_parameters(default_robot_file()).encoder.link_counts[0]);
    return run;
  }
  void expect_refused(const Order& order, const std::string& sentence) {
    const Reply reply = answer_to(order);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    EXPECT_EQ(reply.why.reason, Reason::kNoTrajectory);
    EXPECT_EQ(reply.why.field, "trajectory_id");
    EXPECT_THAT(reply.why.sentence, HasSubstr(sentence));
  }

  std::unique_ptr<Process> executor_;
};

// Every time an executor that has just been started, so that the arm hangs still: what is left then is what repeats.
TEST_F(RepeatTest, TheWrongArmComesToFollowThePlan) {
  serve();
  const std::vector<std::string> arm = wrong_arm();
  start_executor(arm);
  const Run first = run(motion(kLoop));
  std::vector<Run> runs{first};
  for (int i = 0; i < 3; ++i) {
    stop_executor();
    start_executor(arm);
    runs.push_back(run(about(Action::kRepeat, first.id)));
    const Run &last = runs.back(), &before = runs[runs.size() - 2];
    EXPECT_EQ(last.repetition, i + 2);
    EXPECT_EQ(last.learnt.at("motion"), to_text(first.id));
    EXPECT_EQ(last.learnt.at("run"), to_text(before.id));
    EXPECT_LT(last.rms, 0.7 * before.rms) << i;  // measured: 209, 71, 25 and 10 counts
  }
  EXPECT_GT(first.rms, 100);
  EXPECT_LT(runs.back().rms, 0.15 * first.rms);
  EXPECT_THAT(executor_->output(), testing::Not(HasSubstr("refused")));
}

// One after the other on the same executor, each as soon as the one before has its result; any run names the motion.
TEST_F(RepeatTest, ARunIsLearntFromAtOnce) {
  serve();
  start_executor();
  const Run first = run(motion(kLoop));
  RequestId last = first.id;
  for (int i = 2; i < 6; ++i) {
    const Run next = run(about(Action::kRepeat, i % 2 == 0 ? first.id : last));
    EXPECT_EQ(next.repetition, i);
    EXPECT_EQ(next.learnt.at("run"), to_text(last));
    last = next.id;
    // The links' columns are the plan's, and the torque is not.
    ASSERT_GE(next.reply.rows.size(), first.reply.rows.size());
    EXPECT_EQ(next.reply.rows.back().state.q, first.reply.rows.back().state.q);
    EXPECT_NE(next.reply.rows[10].torque, first.reply.rows[10].torque);
  }
}

TEST_F(RepeatTest, AMotionThatHasNotRunRunsAsItWasPlanned) {
  serve();
  start_executor();
  const Order plan = order(kLoop);
  const Reply planned = answer_to(plan);
  const Run first = run(about(Action::kRepeat, plan.id));
  EXPECT_EQ(first.repetition, 1);
  EXPECT_EQ(first.reply.plan_json, planned.plan_json);
  EXPECT_EQ(first.reply.rows.size(), planned.rows.size());
  EXPECT_EQ(run(about(Action::kRepeat, plan.id)).repetition, 2);
}

TEST_F(RepeatTest, ExecutedAsItWasPlannedLearningBeginsAnew) {
  serve();
  start_executor();
  const Run first = run(motion(kLoop));
  const Run second = run(about(Action::kRepeat, first.id));
  EXPECT_EQ(run(about(Action::kRepeat, first.id)).repetition, 3);
  const Run again = run(about(Action::kExecute, first.id));
  EXPECT_EQ(again.repetition, 1);
  EXPECT_EQ(run(about(Action::kRepeat, first.id)).learnt.at("run"), to_text(again.id));
  // What was learnt can be executed as it is, too.
  const Run as_it_was = run(about(Action::kExecute, second.id));
  EXPECT_EQ(as_it_was.reply.plan_json, second.reply.plan_json);
  EXPECT_EQ(run(about(Action::kRepeat, first.id)).repetition, 3);
}

TEST_F(RepeatTest, MotionsThatTakeTurnsLearnEachFromItsOwnLastRun) {
  serve();
  start_executor();
  Run a = run(motion(kLoop)), b = run(motion(kOtherLoop));
  const RequestId one = a.id, other = b.id;
  for (int i = 2; i < 4; ++i) {
    const Run next = run(about(Action::kRepeat, one)), beside = run(about(Action::kRepeat, other));
    EXPECT_EQ(next.learnt.at("run"), to_text(a.id));
    EXPECT_EQ(beside.learnt.at("run"), to_text(b.id));
    EXPECT_EQ(beside.repetition, i);
    a = next;
    b = beside;
  }
}

TEST_F(RepeatTest, WhatCannotBeRepeatedIsRefusedByName) {
  serve();
  const std::vector<std::string> arm = wrong_arm();
  write("executor.yaml", "tolerances: {path: [0.002, 0.002]}\n");
  start_executor(arm);
  RequestId unknown = me_;
  unknown.number = 12345;
  expect_refused(about(Action::kRepeat, unknown), "not among the requests this service has planned lately");
  const Order failing = motion(kLoop);
  EXPECT_EQ(answer_to(failing).state, ReplyState::kSolved);
  const auto result = result_of(failing.id);
  ASSERT_TRUE(result && result->code == ResultCode::kPathToleranceViolated) << executor_->output();
  expect_refused(about(Action::kRepeat, failing.id),
                 "its last run, " + text(failing.id) + ", ended as PATH_TOLERANCE_VIOLATED: link ");
}

// The whole correction takes the model's links 0.04 rad off the plan, and an executor allows twice its path tolerance.
TEST_F(RepeatTest, OfWhatTheExecutorRefusedLessIsTaken) {
  serve();
  const auto start = [&](const std::string& tolerances) {  // the arm hangs still
    const std::vector<std::string> arm = wrong_arm();
    if (!tolerances.empty()) write("executor.yaml", tolerances);
    if (executor_) stop_executor();
    start_executor(arm);
  };
  const auto refused = [&](const RequestId& planned) {
    const Order repeat = about(Action::kRepeat, planned);
    const Reply reply = answer_to(repeat);
    EXPECT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
    return std::pair(nlohmann::json::parse(reply.plan_json).at("repetition").at("fraction").get<double>(),
                     result_of(repeat.id).value_or(ExecutionResult{}));
  };
  start("");
  const RequestId planned = run(motion(kLoop)).id;
  start("tolerances: {path: [0.005, 0.005], goal: [0.5, 0.5], stopped_velocity: [0.5, 0.5]}\n");
  for (const double wanted : {1.0, 0.5}) {
    const auto [fraction, result] = refused(planned);
    EXPECT_EQ(fraction, wanted);
    EXPECT_EQ(result.code, ResultCode::kRepetitionRefused);
    EXPECT_THAT(result.sentence, HasSubstr("learnt for another arm"));
  }
  start("");
  const Run quarter = run(about(Action::kRepeat, planned));
  EXPECT_EQ(quarter.learnt.at("fraction"), 0.25);
  EXPECT_THAT(quarter.learnt.at("reasons").dump(), HasSubstr("the executor has refused 0.5 of the correction"));
  stop_executor();
  executor_ = ServiceTest::start_executor("0.5,0", wrong_arm());  // a refusal for where the arm is says nothing of them
  EXPECT_TRUE(says(*executor_, "executing for")) << executor_->output();
  const auto [fraction, result] = refused(planned);
  EXPECT_EQ(fraction, 1);
  EXPECT_EQ(result.code, ResultCode::kInvalidGoal);
  start("");
  EXPECT_EQ(run(about(Action::kRepeat, planned)).learnt.at("fraction"), 1);
}

TEST_F(RepeatTest, NothingIsRepeatedWhileTheArmMoves) {
  serve();
  start_executor({"--payload", "0.005"});  // by the clock
  const Order slow = motion(kLoop);
  EXPECT_EQ(answer_to(slow).state, ReplyState::kSolved);
  wait_until([&] { return count(executor_->output(), "executing id=") == 1; });
  const Order repeat = about(Action::kRepeat, slow.id);
  send(repeat);
  const Reply reply = final_reply(repeat.id);
  EXPECT_EQ(reply.state, ReplyState::kRejected);
  EXPECT_EQ(reply.why.reason, Reason::kArmNotAtRest);
  EXPECT_EQ(run(repeat).repetition, 2);  // asked for again
}

TEST_F(RepeatTest, WithoutWorkersOfItsOwnAServiceSaysSo) {
  serve("{workers: 0}\n");
  const Order repeat = about(Action::kRepeat, me_);
  start_executor();
  const Reply reply = answer_to(repeat);
  EXPECT_EQ(reply.state, ReplyState::kRejected);
  EXPECT_EQ(reply.why.reason, Reason::kUnsupported);
}

// Who reads fjr/learnt_trajectory beside it, as an observer may, makes no executor of a later version of it.
TEST_F(RepeatTest, AnExecutorOfAnEarlierVersionIsNotGivenWhatWasLearnt) {
  serve();
  const std::string hash = robot_hash(load_parameters(default_robot_file()));
  const dds::Participant earlier(domain_), observer(domain_);
  const dds::Reader<fjr_msg_LearntTrajectory> observed(observer, observer.handle());
  dds::Writer<fjr_msg_ExecutedRun> runs(earlier, earlier.handle());
  const std::jthread resting([&](const std::stop_token& over) {
    dds::Writer<fjr_msg_ExecutorState> states(earlier, earlier.handle());
    ExecutorState state;
    state.robot_id = "arm";
    state.robot_hash = hash;
    for (; !over.stop_requested(); std::this_thread::sleep_for(milliseconds(2))) (void)states.write(dds::encode(state));
  });
  const Order plan = order(kLoop);
  ASSERT_EQ(answer_to(plan).state, ReplyState::kSolved);
  ExecutedRun run;
  run.robot_id = "arm";
  run.robot_hash = hash;
  run.trajectory_id = plan.id;
  run.rows.resize(2);
  run.rows[1].time = 0.001;
  wait_until([&] { return runs.has_reader() && observed.has_writer(); });
  EXPECT_TRUE(runs.write(dds::encode(run)));
  settle();
  expect_refused(about(Action::kRepeat, plan.id), "takes no motions that were learnt");
}

// Whatever somebody tells of a run, no worker is lost over it: the same rows are repeated.
TEST_F(RepeatTest, AForgedRunCostsNoWorker) {
  serve();
  start_executor();
  const dds::Participant forger(domain_);
  dds::Writer<fjr_msg_ExecutedRun> runs(forger, forger.handle());
  wait_until([&] { return runs.has_reader(); });
  for (const double size : {1e308, 1e6, 1e-300}) {
    const Order plan = order(kLoop);
    const Reply planned = answer_to(plan);
    ExecutedRun forged;
    forged.robot_id = "arm";
    forged.robot_hash = planned.robot_hash;
    forged.trajectory_id = plan.id;
    for (int i = 0; i < 900; ++i) {
      const Sample& row = planned.rows[static_cast<std::size_t>(i)];
      forged.rows.push_back({0.001 * i, {size, -size}, {-size, size}, {size, size}, row.state.q, row.state.theta});
    }
    EXPECT_TRUE(runs.write(dds::encode(forged)));
    settle();
    const Order repeat = about(Action::kRepeat, plan.id);
    const Run repeated = run(repeat);
    EXPECT_EQ(repeated.learnt.at("refused"), true);
    EXPECT_EQ(repeated.reply.rows.size(), planned.rows.size());
  }
  EXPECT_EQ(count(service().output(), "worker lost"), 0U) << service().output();
}

// The runs are with the executor, the rows with what the service remembers.
TEST_F(RepeatTest, LearningGoesOnAfterTheServiceWasKilled) {
  const std::string remembering = "{workers: 1, remember: memory}\n";
  serve(remembering);
  start_executor();
  const Run first = run(motion(kLoop)), second = run(about(Action::kRepeat, first.id));
  EXPECT_EQ(second.repetition, 2);
  service().send(SIGKILL);
  EXPECT_EQ(service().wait(), -1);
  serve(remembering);
  const Run third = run(about(Action::kRepeat, first.id));
  EXPECT_EQ(third.repetition, 3);
  EXPECT_EQ(third.learnt.at("run"), to_text(second.id));
}

TEST_F(RepeatTest, LearningGoesOnWithTheStandby) {
  serve("{instance: a}\n");
  wait_until([&] { return heard_.contains("a") && heard_["a"].epoch > 0; });
  write("b.yaml", "{instance: b}\n");
  const auto standby = start_fjr({"serve", "--config", path("b.yaml"), "--domain", domain()}, "b");
  wait_until([&] { return heard_.contains("b"); });
  settle();
  start_executor();
  const Run first = run(motion(kLoop)), second = run(about(Action::kRepeat, first.id));
  const Run planned = run(about(Action::kExecute, first.id));
  const Run learnt = run(about(Action::kExecute, second.id));
  settle();
  service().send(SIGKILL);
  wait_until([&] { return heard_["b"].epoch > 0; });
  const Run third = run(about(Action::kRepeat, first.id));
  EXPECT_EQ(third.repetition, 3);
  EXPECT_EQ(third.learnt.at("run"), to_text(learnt.id));
  // Of the plan that was executed once more nothing but its rows told whose they are.
  EXPECT_EQ(run(about(Action::kRepeat, planned.id)).learnt.at("run"), to_text(third.id));
  EXPECT_EQ(run(about(Action::kExecute, second.id)).repetition, 2);  // it goes out as what it is
}

TEST_F(RepeatTest, TheFolderOfAnEarlierRequestIsRepeated) {
  serve();
  start_executor();
  write("loop.yaml", kLoop);
  const auto request = [&](std::vector<std::string> words, const std::string& log) {
    words.insert(words.begin(), "request");
    words.insert(words.end(), {"--domain", domain()});
    Process process = fjr(words, log);
    return std::pair{process.wait(), process.output()};
  };
  const auto [planned, summary] = request({path("loop.yaml"), "--execute", "--out", path("a")}, "plan");
  ASSERT_EQ(planned, 0) << summary;
  const auto [repeated, told] = request({path("a"), "--repeat", "--out", path("b")}, "repeat");
  ASSERT_EQ(repeated, 0) << told;
  EXPECT_THAT(told, HasSubstr("code 0 SUCCESSFUL"));
  EXPECT_THAT(told, HasSubstr("repetition  2"));
  EXPECT_THAT(contents(path("b/trajectory.csv")), HasSubstr("# status: learnt"));
  const auto [again, more] = request({path("b"), "--repeat", "--json"}, "again");
  EXPECT_EQ(again, 0) << more;
  EXPECT_THAT(more, HasSubstr("\"number\": 3"));
  EXPECT_THAT(told, testing::Not(HasSubstr("as it was planned")));
  const auto [other, plan] = request({path("loop.yaml"), "--out", path("c")}, "other");
  ASSERT_EQ(other, 0) << plan;
  EXPECT_THAT(plan, testing::Not(HasSubstr("as it was planned")));
  const auto [first, as_planned] = request({path("c"), "--repeat"}, "first");
  EXPECT_EQ(first, 0) << as_planned;
  EXPECT_THAT(as_planned, HasSubstr("repetition  1, as it was planned: no run of it is known"));
  EXPECT_EQ(request({path("loop.yaml"), "--repeat"}, "file").first, 2);
  EXPECT_EQ(request({path("a"), "--repeat", "--execute"}, "both").first, 2);
}

}  // namespace
}  // namespace fjr
