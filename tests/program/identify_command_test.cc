// fjr experiment and fjr identify: logs of the virtual rig, and what is found from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

TEST_F(Cli, ExperimentAndIdentifyGoTogether) {
  const Result log = run({"experiment", "link_inertia", "--joint", "2", "--out", "log.csv", "--seed", "7"});
  EXPECT_EQ(log.exit_code, 0);
  EXPECT_THAT(contents(path("log.csv")), HasSubstr("# joint: 2\n"));
  const Result found =
      run({"identify", "link_inertia", "log.csv", "--json", "--out", "robot.yaml", "--report", "r.html"});
  EXPECT_EQ(found.exit_code, 0);
  const Json json = Json::parse(found.out);
  EXPECT_EQ(json[0]["joint"], 2);
  EXPECT_NEAR(json[0]["parameters"]["damping_over_inertia"]["value"], 0.862, 0.01);
  EXPECT_THAT(contents(path("robot.yaml")), HasSubstr("log.csv sha256 " + std::string(json[0]["sha256"])));
  EXPECT_THAT(contents(path("r.html")), HasSubstr("<canvas"));
}

TEST_F(Cli, IdentifyDoesNotReplaceItsLogs) {
  ASSERT_EQ(run({"experiment", "link_inertia", "--joint", "2", "--out", "link_inertia_2.csv"}).exit_code, 0);
  const std::string log = contents(path("link_inertia_2.csv"));
  for (const std::vector<std::string>& logs :
       {std::vector<std::string>{"link_inertia", "link_inertia_2.csv"}, std::vector<std::string>{"all", "."},
        std::vector<std::string>{"executed", "link_inertia_2.csv"}}) {
    for (const std::string option : {"--out", "--report"}) {
      if (logs[0] == "executed" && option == "--report") continue;  // it has none
      const Result result = run({"identify", logs[0], logs[1], option, "link_inertia_2.csv"});
      EXPECT_EQ(result.exit_code, 2);
      EXPECT_THAT(result.err, HasSubstr(option + ": link_inertia_2.csv would overwrite the input "));
    }
  }
  EXPECT_EQ(contents(path("link_inertia_2.csv")), log);

  // The robot file that is refined may be replaced by the refined one, but not by a page.
  write("robot.yaml", contents(FJR_SOURCE_DIR "/config/robot.yaml"));
  const auto refine = [&](const std::string& option) {
    return run({"identify", "link_inertia", "link_inertia_2.csv", "--robot", "robot.yaml", option, "robot.yaml"})
        .exit_code;
  };
  EXPECT_EQ(refine("--report"), 2);
  EXPECT_EQ(refine("--out"), 0);
}

// The virtual rig's logs may be made again, with another seed too; a real rig's, of the same names, never are replaced.
TEST_F(Cli, ExperimentsReplaceNoLogsOfARealRig) {
  const std::string measured = "# experiment: stiffness\ntime,q1,q2,theta1,theta2,tau1,tau2\n";
  fs::create_directory(path("rig"));
  write("rig/motor_inertia_2.csv", measured);
  const Result all = run({"experiment", "all", "--out", "rig"});
  EXPECT_EQ(all.exit_code, 2);
  EXPECT_THAT(all.err, HasSubstr("--out: rig/motor_inertia_2.csv is no log of the virtual rig, and would be lost"));
  EXPECT_FALSE(fs::exists(path("rig/gravity_1.csv")));
  EXPECT_EQ(run({"experiment", "motor_inertia", "--joint", "2", "--out", "rig/motor_inertia_2.csv"}).exit_code, 2);
  EXPECT_EQ(contents(path("rig/motor_inertia_2.csv")), measured);

  const auto push = [&](const char* seed) {
    return run({"experiment", "motor_inertia", "--joint", "2", "--out", "push.csv", "--seed", seed}).exit_code;
  };
  EXPECT_EQ(push("1"), 0);
  EXPECT_EQ(push("2"), 0);
  EXPECT_THAT(contents(path("push.csv")), HasSubstr("# seed: 2\n"));
}

TEST_F(Cli, ExperimentAndIdentifyRefuseBadInput) {
  EXPECT_EQ(run({"experiment", "juggling", "--joint", "1", "--out", "log.csv"}).exit_code, 2);
  EXPECT_EQ(run({"experiment", "link_inertia", "--out", "log.csv"}).exit_code, 2);
  EXPECT_EQ(run({"experiment", "link_inertia", "--joint", "3", "--out", "log.csv"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(path("log.csv")));
  EXPECT_EQ(run({"identify", "stiffness", "none.csv"}).err, "fjr: none.csv: no such file\n");
  EXPECT_EQ(run({"identify", "all", "none"}).exit_code, 2);
  write("log.csv", "time,q1\n");
  const Result broken = run({"identify", "stiffness", "log.csv", "--out", "robot.yaml"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_EQ(broken.err, "fjr: log.csv: line 1: column q2 is missing in 'time,q1'\n");
  EXPECT_FALSE(fs::exists(path("robot.yaml")));
}

TEST_F(Cli, LogsThatContradictEachOtherAreRefusedUnlessAccepted) {
  std::string other = contents(FJR_SOURCE_DIR "/config/robot.yaml");
  const std::string inertia = "inertia: {value: [0.0686, 0.0145]";
  ASSERT_NE(other.find(inertia), std::string::npos);
  other.replace(other.find(inertia), inertia.size(), "inertia: {value: [0.0686, 0.0160]");
  write("other.yaml", other);
  const std::vector<std::string> push = {"experiment", "motor_inertia", "--joint", "2"};
  const auto perform = [&](const std::string& log, const std::string& seed, const std::string& robot) {
    std::vector<std::string> words = push;
    words.insert(words.end(), {"--out", log, "--seed", seed, "--robot", robot});
    return run(words).exit_code;
  };
  ASSERT_EQ(perform("a.csv", "1", FJR_SOURCE_DIR "/config/robot.yaml"), 0);
  ASSERT_EQ(perform("b.csv", "2", FJR_SOURCE_DIR "/config/robot.yaml"), 0);
  ASSERT_EQ(perform("c.csv", "3", "other.yaml"), 0);

  const Result agreeing = run({"identify", "motor_inertia", "a.csv", "b.csv", "--out", "ab.yaml"});
  EXPECT_EQ(agreeing.exit_code, 0);
  EXPECT_EQ(agreeing.err, "");
  EXPECT_THAT(agreeing.out, AllOf(HasSubstr("together: motor_inertia, joint 2 (a.csv, b.csv)"),
                                  HasSubstr("inertia, joint 2: motor_inertia (a.csv) says 0.0145")));
  EXPECT_THAT(contents(path("ab.yaml")), AllOf(HasSubstr("a.csv sha256"), HasSubstr("b.csv sha256")));

  const Result refused = run({"identify", "motor_inertia", "a.csv", "c.csv", "--out", "ac.yaml"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("the logs contradict each other: inertia, joint 2"), HasSubstr("--accept-inconsistent")));
  EXPECT_FALSE(fs::exists(path("ac.yaml")));

  const Result accepted =
      run({"identify", "motor_inertia", "a.csv", "c.csv", "--out", "ac.yaml", "--accept-inconsistent"});
  EXPECT_EQ(accepted.exit_code, 0);
  EXPECT_THAT(accepted.err, HasSubstr("fjr: warning: inertia, joint 2"));
  EXPECT_TRUE(fs::exists(path("ac.yaml")));
}

}  // namespace
}  // namespace fjr
