// `fjr ros2-action` and a client that knows ROS 2's definitions only (ros_client.h), with service and executor, each a
// process of its own.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "tests/service/ros2/ros_client.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

using ros2_test::Client;
using ros2_test::Feedback;
using ros2_test::Goal;
using ros2_test::Result;
using ros2_test::Uuid;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kGoalTolerance = 0.005;  // [rad] the executor's own, config/executor.yaml

class Ros2ActionTest : public ServiceProcesses {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    ::setenv("CYCLONEDDS_URI", "file://" FJR_SOURCE_DIR "/config/cyclonedds.xml", 1);  // the network that fjr is on
    service_ = serve();
    executor_ = fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log");
    ASSERT_TRUE(comes_true([&] { return executor_->output().find("executing for") != std::string::npos; }, 30));
    bridge_ = fjr({"ros2-action"}, "bridge.log");
    client_ = std::make_unique<Client>(domain_);
    ASSERT_TRUE(comes_true([&] { return client_->server_is_available(); }, 30)) << bridge_->output();
  }

  Client& client() { return *client_; }
  Process& bridge() { return *bridge_; }

  std::string status() const {
    const auto said = fjr({"status", "--json"}, "status.log");
    (void)said->wait();
    return said->output();
  }

  // Sends the goal and waits until it is over.
  Result outcome(const Goal& goal) {
    const Uuid id = ros2_test::random_uuid();
    EXPECT_EQ(client().send(id, goal), true);
    const auto result = client().result(id);
    if (!result) ADD_FAILURE() << "no result";
    return result.value_or(Result{});
  }

 private:
  std::unique_ptr<Process> service_, executor_, bridge_;
  std::unique_ptr<Client> client_;
};

Goal to(std::vector<double> positions, double time = 0) {
  Goal goal;
  goal.points.push_back({std::move(positions)});
  goal.points.back().time = time;
  return goal;
}

TEST_F(Ros2ActionTest, AGoalIsExecutedAndReported) {
  const Uuid id = ros2_test::random_uuid();
  Goal goal = to({-0.1, 0.6}, 1.0);
  goal.names = {"joint2", "joint1"};  // any order
  ASSERT_EQ(client().send(id, goal), true);
  const auto result = client().result(id);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, ros2_test::kSucceeded) << result->text;
  EXPECT_EQ(result->code, 0) << result->text;

  const std::vector<Feedback> feedback = client().take_feedback();
  // 1 s of motion and 0.5 s of watching the goal, at 10 Hz and more.
  ASSERT_GE(feedback.size(), 15U);
  double before = 0;
  for (const Feedback& one : feedback) {
    EXPECT_EQ(one.id, id);
    EXPECT_THAT(one.names, ElementsAre("joint2", "joint1"));
    EXPECT_GE(one.time, before);
    before = one.time;
    ASSERT_EQ(one.actual.size(), 2U);
    for (std::size_t j = 0; j < 2; ++j) EXPECT_EQ(one.error[j], one.desired[j] - one.actual[j]);
  }
  EXPECT_NEAR(feedback.front().actual[0], 0.2, 0.1);  // joint 2 began there; the first is of the first tenths
  EXPECT_NEAR(feedback.back().actual[0], -0.1, kGoalTolerance);
  EXPECT_NEAR(feedback.back().actual[1], 0.6, kGoalTolerance);
  EXPECT_THAT(client().take_statuses(id), ElementsAre(ros2_test::kExecuting, ros2_test::kSucceeded));
}

}  // namespace
}  // namespace fjr
