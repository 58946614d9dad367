// fjr robot: new robots, described in a file or on a terminal, and robots that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

const std::string kGood = "start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: free\nobjective: fastest\n";

const std::string kDescription =
    "length: [0.4, 0.3]\nmass: [1.5, 0.7]\ncenter_of_mass: [0.2, 0.12]\ninertia: [0.03, 0.006]\nstiffness: [30, 15]\n"
    "rotor_inertia: [1e-5, 4e-6]\ngear: [80, 50]\ntorque: [14, 5]\nvelocity: [6, 8]\nposition: [[-1, 3], [-2.5, 2.5]]\n"
    "deflection: [0.5, 0.3]\n";

TEST_F(Cli, ANewRobotIsDescribedCheckedAndPlannedFor) {
  write("short.yaml", kDescription);
  const Result made = run({"robot", "new", "short.yaml", "--out", "robot.yaml"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  const Result checked = run({"robot", "check", "robot.yaml", "--json"});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_EQ(Json::parse(checked.out)["possible"], true);
  EXPECT_GT(Json::parse(checked.out)["findings"].size(), 20U);
  write("good.yaml", kGood);
  const Result planned = run({"plan", "good.yaml", "--out", "out", "--robot", "robot.yaml", "--report"});
  EXPECT_EQ(planned.exit_code, 0) << planned.out << planned.err;
  EXPECT_EQ(plan_json()["robot_hash"], Json::parse(checked.out)["robot_hash"]);

  EXPECT_THAT(contents(path("out/report.html")), HasSubstr("limits -1 to 3 and ±2.5 rad"));
  EXPECT_THAT(contents(path("out/report.html")),
              HasSubstr("link position 1 is counted from 1 rad, the middle of -1 to 3"));
  EXPECT_THAT(contents(path("out/report.html")), HasSubstr("\"gravity\":{\"fraction\":1.0,\"down\":0.0}"));
  EXPECT_THAT(run({"plan", "good.yaml", "--robot", "robot.yaml", "--explain-request"}).out,
              HasSubstr("[2, 2.5] rad to either side of [1, 0] rad\n"));

  const std::string before = contents(path("robot.yaml"));  // nothing is overwritten
  EXPECT_EQ(run({"robot", "new", "short.yaml", "--out", "robot.yaml"}).exit_code, 2);
  EXPECT_EQ(contents(path("robot.yaml")), before);
  write("named.yaml", kGood + "robot: robot.yaml\n");
  EXPECT_THAT(run({"plan", "named.yaml", "--out", "named", "--robot", "robot.yaml"}).err,
              HasSubstr("named.yaml: robot: is named already"));
}

TEST_F(Cli, RobotsThatCannotBeAreRefusedWithTheReason) {
  std::string impossible = kDescription;
  impossible.replace(impossible.find("[0.03, 0.006]"), 13, "{value: [0.001, 0.006], about: [joint, center_of_mass]}");
  write("short.yaml", impossible);
  const Result made = run({"robot", "new", "short.yaml", "--out", "robot.yaml"});
  EXPECT_EQ(made.exit_code, 2);
  EXPECT_THAT(made.err, HasSubstr("short.yaml: inertia[0]: 0.001 kg m^2 about the joint is 0.0167 of the 0.06 kg m^2"));
  EXPECT_FALSE(fs::exists(path("robot.yaml")));

  std::string text = contents(FJR_SOURCE_DIR "/config/robot.yaml");
  text.replace(text.find("[0.0915, 7.1672e-3]"), 19, "[0.001, 7.1672e-3]");
  write("robot.yaml", text);
  const Result checked = run({"robot", "check", "robot.yaml"});
  EXPECT_EQ(checked.exit_code, 2);
  EXPECT_THAT(checked.out, HasSubstr("there can be no such arm"));
  EXPECT_THAT(checked.out, HasSubstr("no such arm\n  impossible parallel axes, joint 1: 0.001 kg m^2"));  // first
  write("good.yaml", kGood);
  EXPECT_THAT(run({"plan", "good.yaml", "--out", "out", "--robot", "robot.yaml"}).err, HasSubstr("0.00972 of the"));
  EXPECT_EQ(run({"robot", "new", "--out", "x.yaml"}).exit_code, 2);  // no terminal to ask on
}

// As somebody at a terminal: a mistake is told and asked about again, what may be left out is left out.
TEST_F(Cli, ANewRobotIsAskedForOnATerminal) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  ASSERT_GE(child, 0);
  if (child == 0) {
    fs::current_path(path("."));
    execl(FJR_EXECUTABLE, "fjr", "robot", "new", "--out", "robot.yaml", nullptr);
    _exit(127);
  }
  const std::string answers =
      "an arm\n\n0.4, 0.3\n1.5, minus\n1.5, 0.7\n[0.2, 0.12]\n0.03, 0.006\n30, 15\n1e-5, 4e-6\n80, 50\n14, 5\n6, 8\n"
      "[[-1, 3], [-2.5, 2.5]]\n0.5, 0.3\n\n\n\n\n\n\n\n\n\n\n";
  ASSERT_EQ(::write(terminal, answers.data(), answers.size()), static_cast<ssize_t>(answers.size()));
  std::string said;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t count = ::read(terminal, part.data(), part.size());
    if (count <= 0) break;
    said.append(part.data(), static_cast<std::size_t>(count));
  }
  int status = 0;
  waitpid(child, &status, 0);
  ::close(terminal);
  EXPECT_EQ(WEXITSTATUS(status), 0) << said;
  EXPECT_THAT(said, HasSubstr("\"minus\" is not a finite number"));
  EXPECT_THAT(contents(path("robot.yaml")), HasSubstr("link_middle: {value: [1, 0]"));
}

}  // namespace
}  // namespace fjr
