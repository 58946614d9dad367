// The executor where something fails: ticks, threads, the arm or an encoder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <string>
#include <thread>

#include "planner/executor/executor.h"
#include "planner/executor/virtual_arm.h"
#include "tests/executor/executor_fixture.h"

namespace fjr {
namespace {

using testing::HasSubstr;

// Its process is stopped for 3 s in mid-motion: the drives brake meanwhile, and the motion does not go on.
TEST_F(ExecutorTest, StopsWhenItsTicksAreMissed) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId id = cell().publish(kFrom, kTo, 1.5);
  ASSERT_TRUE(cell().wait_for_time(0.2));  // the sooner, the less a busy machine does the same itself
  arm->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(3));
  arm->send(SIGCONT);
  const ExecutionResult result = cell().result(id);
  EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated);
  int missed = 0;
  EXPECT_EQ(std::sscanf(result.sentence.c_str(), "%d control ticks in a row were missed at", &missed), 1)
      << result.sentence;
  EXPECT_GT(missed, 2900);
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kHolding));
  EXPECT_LT(cell().state.q[0], kTo[0] - 0.1);  // short of the goal
  const std::string ticks = read_log(result.log_file).metadata.at("missed_ticks");
  EXPECT_GE(std::stoi(ticks), missed);

  // Of the next motion, only its own. Not every one from there can be published exactly.
  ExecutionResult next;
  for (int i = 0; i < 8 && next.log_file.empty(); ++i) {
    const Joints<double> to{kTo[0] - 0.05 * i, kTo[1] - 0.1 * i};
    next = cell().result(cell().publish(cell().state.planned_q, to, 1.2));
  }
  ASSERT_FALSE(next.log_file.empty()) << next.sentence;
  EXPECT_LT(std::stoi(read_log(next.log_file).metadata.at("missed_ticks")), missed);
}

// With a payload that nobody told it of, which pulls at it as soon as it does not hang straight down.
TEST_F(ExecutorTest, HoldsWhenTheArmIsNotTheOneThatWasPlannedFor) {
  write("executor.yaml", "virtual_arm: {start: [0, 0], payload: 0.5}\n");
  const auto arm = executor({"--fast", "--config", path("executor.yaml")});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const ExecutionResult result = cell().result(cell().publish({0, 0}, {0.6, -0.5}, 0.55));
  EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated) << result.sentence;
  EXPECT_THAT(result.sentence, HasSubstr("rad off the plan at"));
  EXPECT_TRUE(cell().wait_for(ExecutorMode::kHolding));
}

// No thread can be started, as where a limit of the system is reached: memory for its stack is refused here.
TEST_F(ExecutorTest, RefusesWhatItHasNoThreadToPrepareWith) {
  const auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  std::istringstream size(contents("/proc/" + std::to_string(arm->pid()) + "/statm"));
  rlim_t pages = 0;
  size >> pages;
  const rlim_t room = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (4 << 20);  // a stack takes 8 MB
  const rlimit narrow{room, RLIM_INFINITY}, wide{RLIM_INFINITY, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(arm->pid(), RLIMIT_AS, &narrow, nullptr), 0);
  const ExecutionResult refused = cell().result(cell().publish(kFrom, kTo, 0.6));
  EXPECT_EQ(refused.code, ResultCode::kInvalidGoal);
  EXPECT_THAT(refused.sentence, HasSubstr("cannot be prepared"));
  ASSERT_EQ(::prlimit(arm->pid(), RLIMIT_AS, &wide, nullptr), 0);
  const ExecutionResult result = cell().result(cell().publish(kFrom, kTo, 0.6));
  EXPECT_EQ(result.code, ResultCode::kSuccessful) << result.sentence;
}

// Its field bus fails while a motion is prepared.
TEST_F(ExecutorTest, EndsAtOnceWhenTheArmFails) {
  struct FailingArm : VirtualArm {
    using VirtualArm::VirtualArm;
    Reading read(int ticks) override {
      if (fails) throw std::runtime_error("the field bus is gone");
      return VirtualArm::read(ticks);
    }
    std::atomic<bool> fails = false;
  };
  ExecutorConfig config = default_executor_config();
  config.network.domain = domain();
  config.state = path("state");
  config.priority = 0;  // of the test's own process
  VirtualArmOptions options = config.arm;
  options.truth = robot();
  FailingArm arm(options, kFrom);
  std::chrono::steady_clock::time_point failed;
  std::string sentence;
  std::thread running([&] {
    try {
      Executor(config, robot(), arm).run();
    } catch (const std::exception& error) {
      sentence = error.what();
    }
  });
  EXPECT_TRUE(cell().wait_for(ExecutorMode::kResting));
  (void)cell().publish(kFrom, kBeyond, 5);
  EXPECT_TRUE(cell().wait_for(ExecutorMode::kPreparing));
  failed = std::chrono::steady_clock::now();
  arm.fails = true;
  running.join();
  EXPECT_EQ(sentence, "the field bus is gone");
  const auto found = std::chrono::steady_clock::now();
  (void)stop_motions(robot(), {cell().order(kFrom, kBeyond, 5).rows, {}}, {});
  const auto all_found = std::chrono::steady_clock::now();
  EXPECT_LT(found - failed, (all_found - found) / 2);  // the half of what preparing takes beside the judgement
}

TEST_F(ExecutorTest, HoldsWhenAnEncoderFallsSilent) {
  write("executor.yaml", "virtual_arm: {start: [0.3, 0.2], encoder_fault: {encoder: theta2, above: 0.5}}\n");
  const auto arm = executor({"--fast", "--config", path("executor.yaml")});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const ExecutionResult result = cell().result(cell().publish(kFrom, kTo, 0.6));
  EXPECT_EQ(result.code, ResultCode::kPathToleranceViolated);
  EXPECT_THAT(result.sentence, HasSubstr("the encoder theta2 gave no more samples at"));
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kHolding));
  EXPECT_THAT(cell().result(cell().publish(cell().state.q, kTo, 0.6)).sentence,
              HasSubstr("the encoder theta2 gives no samples"));
}

}  // namespace
}  // namespace fjr
