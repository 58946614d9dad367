// What the executor remembers of trajectories, also after it was restarted: none runs twice, each has its result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/input_error.h"
#include "planner/executor/history.h"
#include "tests/executor/executor_fixture.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Replayed, or of an owner that another has taken the robot from: over restarts too.
TEST_F(ExecutorTest, RemembersWhatItRanAndForWhom) {
  auto arm = executor({"--fast"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  TrajectoryOrder order = cell().order(kFrom, kTo, 0.6);
  order.epoch = 7;
  const RequestId ran = cell().publish(order);
  EXPECT_EQ(cell().result(ran).code, ResultCode::kSuccessful) << cell().result(ran).sentence;
  arm->send(SIGTERM);
  EXPECT_EQ(arm->wait(), 0) << arm->output();
  cell().results.clear();
  cell().state = {};
  arm = executor({"--fast"});  // at kFrom again
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  EXPECT_EQ(cell().state.epoch, 7u);
  EXPECT_EQ(cell().result(ran).code, ResultCode::kSuccessful);  // as it was
  cell().farthest = {};
  TrajectoryOrder replayed = cell().order(kFrom, kTo, 0.6);
  replayed.epoch = 7;
  replayed.id = ran;
  (void)cell().publish(replayed);
  cell().listen_for(0.2);
  EXPECT_EQ(cell().results[ran].size(), 1U);
  TrajectoryOrder superseded = cell().order(kFrom, kTo, 0.6);
  superseded.epoch = 6;
  EXPECT_THAT(cell().result(cell().publish(superseded)).sentence,
              HasSubstr("from an earlier owner: epoch 6, 7 was seen"));
  cell().listen_for(0.5);
  EXPECT_LT(cell().farthest[0], 1e-3);
}

TEST_F(ExecutorTest, DoesNotMoveOnWhatWasPublishedBeforeItStarted) {
  const RequestId id = cell().publish(kFrom, kTo, 0.5);
  const auto arm = executor();
  const ExecutionResult result = cell().result(id);
  EXPECT_EQ(result.code, ResultCode::kOldHeaderTimestamp);
  EXPECT_THAT(result.sentence, HasSubstr("published before the executor was started"));
  cell().listen_for(0.5);
  EXPECT_LT(cell().farthest[0], 1e-3);
}

TEST_F(ExecutorTest, NeverRunsTwiceWhatItWasKilledIn) {
  auto arm = executor();
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId id = cell().publish(kFrom, kTo, 1.5);
  ASSERT_TRUE(cell().wait_for_time(0.3));
  arm->send(SIGKILL);
  (void)arm->wait();
  cell().listen_for(0.2);  // its last words
  cell().farthest = {};
  cell().state = {};
  cell().results.clear();
  arm = executor();  // the trajectory is still there, for late joiners
  const ExecutionResult result = cell().result(id);
  EXPECT_NE(result.code, ResultCode::kSuccessful);
  EXPECT_THAT(result.sentence, HasSubstr("the executor ended while it ran; it is not run again"));
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  cell().listen_for(0.5);
  EXPECT_LT(cell().farthest[0], 1e-3);
  EXPECT_EQ(cell().results[id].size(), 1U);
}

TEST_F(ExecutorTest, ReportsTheLatestAgainAfterARestartAndRests) {
  auto arm = executor({"--fast"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const RequestId id = cell().publish(kFrom, kTo, 0.5);
  EXPECT_EQ(cell().result(id).code, ResultCode::kSuccessful);
  arm->send(SIGTERM);
  EXPECT_EQ(arm->wait(), 0) << arm->output();
  cell().listen_for(0.1);
  cell().results.clear();
  cell().farthest = {};
  arm = executor({"--fast"});
  EXPECT_EQ(cell().result(id).code, ResultCode::kSuccessful);  // as it was
  cell().listen_for(0.3);
  EXPECT_LT(cell().farthest[0], 1e-3);
}

// The client asks for a motion once more after executor and service were restarted: published again, reported again.
TEST_F(ExecutorTest, ReportsWhatRanBeforeItsStartWhenItIsPublishedAgain) {
  auto arm = executor({"--fast"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  const TrajectoryOrder order = cell().order(kFrom, kTo, 0.5);
  cell().publish(order);
  EXPECT_EQ(cell().result(order.id).code, ResultCode::kSuccessful);
  arm->send(SIGKILL);
  (void)arm->wait();
  forget_cell();  // with what it published for late joiners
  arm = executor({"--fast"});
  ASSERT_TRUE(cell().wait_for(ExecutorMode::kResting));
  TrajectoryOrder again = order;
  again.published = nanoseconds_now();
  cell().publish(again);
  EXPECT_EQ(cell().result(order.id).code, ResultCode::kSuccessful);
  cell().listen_for(0.3);
  EXPECT_LT(cell().farthest[0], 1e-3);
  EXPECT_EQ(cell().results[order.id].size(), 1U);
}

TEST(History, SurvivesARestartAndRefusesWhatItIsNot) {
  const fs::path file = fs::temp_directory_path() / ("fjr_history_" + std::to_string(::getpid()));
  RequestId first = new_client(), second = new_client();
  second.number = 3;
  {
    History history(file);
    history.begin(first, 5);
    history.end(first, ResultCode::kPathToleranceViolated, "link 1 was off");
    history.begin(second, 4);
  }
  const History again(file);
  EXPECT_EQ(again.epoch(), 5u);
  ASSERT_NE(again.find(first), nullptr);
  EXPECT_EQ(again.find(first)->code, ResultCode::kPathToleranceViolated);
  EXPECT_EQ(again.find(first)->sentence, "link 1 was off");
  ASSERT_NE(again.find(second), nullptr);
  EXPECT_FALSE(again.find(second)->code);
  EXPECT_EQ(again.find(new_client()), nullptr);
  std::ofstream(file) << "something else\n";
  EXPECT_THROW(History{file}, InputError);
  fs::remove(file);
  EXPECT_EQ(History(file).epoch(), 0u);
  fs::create_directory(file);  // opens, and cannot be read: no executor that has run nothing
  EXPECT_THROW(History{file}, std::runtime_error);
  fs::remove(file);
}

TEST(History, ForgetsWhatItCouldNotRecord) {
  const fs::path folder = fs::temp_directory_path() / ("fjr_history_of_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  History history(folder / "executor");
  const RequestId first = new_client();
  history.begin(first, 5);
  fs::remove_all(folder);
  const RequestId second = new_client();
  EXPECT_THROW(history.begin(second, 6), std::runtime_error);
  EXPECT_NE(history.find(first), nullptr);
  EXPECT_EQ(history.find(second), nullptr);  // it did not run
  EXPECT_EQ(history.epoch(), 5u);
}

}  // namespace
}  // namespace fjr
