// The configuration of the executor.
#include "planner/executor/executor_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/executor/executor_fixture.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(ExecutorTest, SaysWhatIsWrongWithItsConfiguration) {
  const auto refused = [this](const std::string& yaml, const std::string& sentence) {
    write("executor.yaml", yaml);
    const auto arm = executor({"--config", path("executor.yaml")});
    EXPECT_EQ(arm->wait(), 2) << yaml;
    EXPECT_THAT(arm->output(), HasSubstr(sentence));
  };
  refused("{domian: 1}", "domian");
  refused("{oldest: -1}", "executor.yaml: oldest: -1 s is outside (0, 3600 s]");
  refused("{priority: 100}", "executor.yaml: priority: 100 is outside [0, 99]");
  refused("{tolerances: {path: [0.01, 5]}}", "executor.yaml: tolerances.path[1]: 5 rad is outside");
  refused("{virtual_arm: {encoder_fault: {encoder: q3, above: 1}}}",
          "encoder: \"q3\" is not one of q1, q2, theta1, theta2; did you mean q1?");
  refused("{virtual_arm: {start: [9, 0]}}", "start.q[0]: 9 rad is outside [-3.2, 3.2]");
}

TEST(ExecutorConfig, TheShippedFileIsTheDefaults) {
  const ExecutorConfig shipped = load_executor_config(default_robot_file().parent_path() / "executor.yaml"),
                       standard = default_executor_config();
  EXPECT_EQ(shipped.network.domain, standard.network.domain);
  EXPECT_EQ(shipped.network.allow_insecure_network, standard.network.allow_insecure_network);
  EXPECT_EQ(shipped.robot_id, standard.robot_id);
  EXPECT_EQ(shipped.priority, standard.priority);
  EXPECT_EQ(shipped.oldest, standard.oldest);
  EXPECT_EQ(shipped.tolerances.path, standard.tolerances.path);
  EXPECT_EQ(shipped.tolerances.goal, standard.tolerances.goal);
  EXPECT_EQ(shipped.tolerances.goal_time, standard.tolerances.goal_time);
  EXPECT_EQ(shipped.tolerances.stopped_velocity, standard.tolerances.stopped_velocity);
  EXPECT_TRUE(fs::equivalent(shipped.robot, standard.robot));
}

}  // namespace
}  // namespace fjr
