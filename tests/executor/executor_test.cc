// The executor: what it refuses, and a motion from the request to the simulated arm through real processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "planner/executor/acceptance.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;

Situation at_rest() {
  Situation situation;
  situation.robot_hash = "mine";
  situation.started = 100 * kSecond;
  situation.now = 200 * kSecond;
  situation.epoch = 3;
  situation.q = {0.3, 0.2};
  return situation;
}

TrajectoryOrder good() {
  TrajectoryOrder order;
  order.id.number = 1;
  order.robot_hash = "mine";
  order.epoch = 3;
  order.published = 199 * kSecond;
  order.certified = order.ends_at_rest = true;
  order.rows.resize(3);
  for (std::size_t i = 0; i < order.rows.size(); ++i) {
    order.rows[i].time = 0.001 * static_cast<double>(i);
    order.rows[i].state.q = {0.305, 0.195};
  }
  return order;
}

TEST(Acceptance, TakesWhatIsInOrder) { EXPECT_FALSE(refusal_of(good(), at_rest())); }

TEST(Acceptance, RefusesWithTheReason) {
  const auto refused = [](auto change, ResultCode code, const std::string& sentence) {
    TrajectoryOrder order = good();
    Situation situation = at_rest();
    change(order, situation);
    const auto refusal = refusal_of(order, situation);
    ASSERT_TRUE(refusal) << sentence;
    EXPECT_EQ(refusal->code, code) << sentence;
    EXPECT_THAT(refusal->sentence, HasSubstr(sentence));
  };
  using Order = TrajectoryOrder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](Order& o, Situation&) { o.robot_hash = "other"; }, ResultCode::kInvalidJoints, "another robot");
  refused([](Order& o, Situation&) { o.certified = false; }, ResultCode::kInvalidGoal, "not certified");
  refused([](Order& o, Situation&) { o.ends_at_rest = false; }, ResultCode::kInvalidGoal, "does not end at rest");
  refused([](Order& o, Situation&) { o.rows.resize(1); }, ResultCode::kInvalidGoal, "at least 2");
  refused([=](Order& o, Situation&) { o.rows[2].torque[1] = nan; }, ResultCode::kInvalidGoal, "row 2 is not finite");
  refused([](Order& o, Situation&) { o.rows[2].time = 0; }, ResultCode::kInvalidGoal,
          "time does not increase at row 2");
  refused([](Order& o, Situation&) { o.epoch = 2; }, ResultCode::kInvalidGoal, "from an earlier owner");
  refused([](Order& o, Situation&) { o.rows[0].state.dq[0] = 1; }, ResultCode::kInvalidGoal, "does not begin at rest");
  refused([=](Order& o, Situation&) { o.tolerances.path[1] = nan; }, ResultCode::kInvalidGoal, "a tolerance is");
  refused([=](Order& o, Situation&) { o.tolerances.goal_time = -1; }, ResultCode::kInvalidGoal, "a tolerance is");
  refused([](Order&, Situation& s) { s.mode = ExecutorMode::kStopped; }, ResultCode::kInvalidGoal, "was stopped");
  refused([](Order&, Situation& s) { s.lost = "theta2"; }, ResultCode::kInvalidGoal, "encoder theta2 gives no samples");
  refused([](Order& o, Situation&) { o.published = 99 * kSecond; }, ResultCode::kOldHeaderTimestamp, "before");
  refused([](Order& o, Situation&) { o.published = 150 * kSecond; }, ResultCode::kOldHeaderTimestamp, "50.0 s ago");
  refused([](Order&, Situation& s) { s.mode = ExecutorMode::kExecuting; }, ResultCode::kInvalidGoal, "not at rest");
  refused([](Order&, Situation& s) { s.q[1] = 0.18; }, ResultCode::kInvalidGoal, "starts at q2 = 0.195 rad");
}

class ExecutorTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    std::ofstream(path("there.yaml")) << "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\nobjective: fastest\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }
  Process fjr(std::vector<std::string> words, const std::string& log) const {
    if (words[0] == "executor") words.insert(words.end(), {"--state", path("state"), "--logs", path("logs")});
    words.insert(words.begin(), FJR_EXECUTABLE);
    words.insert(words.end(), {"--domain", std::to_string(20 + ::getpid() % 200)});
    return Process(words, path(log));
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("fjr_executor_test_" + std::to_string(::getpid()));
};

TEST_F(ExecutorTest, MovesTheArmAndThenRefusesToStartFromElsewhere) {
  Process service = fjr({"serve"}, "serve.log");
  Process executor = fjr({"executor", "--start", "0.3,0.2"}, "executor.log");
  Process first = fjr({"request", path("there.yaml"), "--execute"}, "first.log");
  EXPECT_EQ(first.wait(), 0) << first.output() << executor.output();
  EXPECT_THAT(first.output(), HasSubstr("execution   code 0"));
  Process second = fjr({"request", path("there.yaml"), "--execute"}, "second.log");
  EXPECT_EQ(second.wait(), 1) << second.output();
  // 0.42 rad but for the swing, about two counts of the encoder, that motor 2 keeps up at rest.
  EXPECT_THAT(second.output(), testing::ContainsRegex("starts at q1 = 0.3 rad, the arm is at 0.4(19[89]|2)"));
  executor.send(SIGTERM);
  EXPECT_EQ(executor.wait(), 0);
}

TEST_F(ExecutorTest, DoesNotMoveOnWhatWasPublishedBeforeItStarted) {
  Process service = fjr({"serve"}, "serve.log");
  Process request = fjr({"request", path("there.yaml"), "--execute"}, "request.log");
  while (service.output().find("SOLVED") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  Process executor = fjr({"executor", "--start", "0.3,0.2"}, "executor.log");
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("published before the executor was started"));
}

}  // namespace
}  // namespace fjr
