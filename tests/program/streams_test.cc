// What the built program says on stdout and stderr, and what becomes of its work where nobody reads that any more.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kGood = "start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: free\nobjective: fastest\n";

class Streams : public Cli {};

// A program that reads stdout need not look elsewhere for what was wrong.
TEST_F(Streams, WithJsonWhatIsWrongIsJsonToo) {
  write("bad.yaml", "link: 3\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"paln", "--json"}, "command line: no subcommand is called paln; did you mean plan? (see --help)"},
      {{"plan", "--json"}, "command line: requests is required (see --help)"},
      {{"verify", "none.csv", "--json"}, "none.csv: no such file"},
      {{"simulate", "none.csv", "--out", "a.csv", "--json"}, "none.csv: no such file"},
      {{"identify", "all", "none", "--json"}, "none: 'all' needs one folder with <experiment>_<joint>.csv"},
      {{"batch", "status", "none", "--json"},
       "none: holds no manifest.sqlite: it is no packed batch (fjr batch prepare REQUESTS... --out DIR)"}};
  for (const auto& [arguments, reason] : wrong) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "fjr: " + reason + "\n");
    EXPECT_EQ(Json::parse(result.out),
              (Json{{"version", FJR_VERSION}, {"status", "bad_input"}, {"reason", reason}, {"field", nullptr}}));
  }
  const Json robot = Json::parse(run({"robot", "check", "bad.yaml", "--json"}).out);
  EXPECT_EQ(robot["field"], "link");
}

TEST_F(Streams, SigtermAndAClosedTerminalCancel) {
  write("slow.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: {effort: 1}\n");
  write("good.yaml", kGood);
  const auto end_of = [&](int signal, const std::string& request, const std::string& out) {
    const pid_t child = start({"plan", request, "--out", out});
    for (int i = 0; i < 1000 && !fs::exists(path(out)); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, signal);
    return finish(child).exit_code;
  };
  for (const int signal : {SIGTERM, SIGHUP}) {
    const std::string out = "out" + std::to_string(signal);
    EXPECT_EQ(end_of(signal, "slow.yaml", out), 5);
    EXPECT_EQ(plan_json(out)["status"], "cancelled");
    EXPECT_FALSE(fs::exists(path(out + "/trajectory.csv")));
  }
  const auto before = ::signal(SIGHUP, SIG_IGN);  // as nohup does
  EXPECT_EQ(end_of(SIGHUP, "good.yaml", "nohup"), 0);
  ::signal(SIGHUP, before);
}

// Progress and messages go to a terminal that is no longer there.
TEST_F(Streams, WhenItsTerminalIsClosedABatchEndsInOrder) {
  constexpr int kRequests = 20;  // more than are planned before it ends
  for (int i = 10; i < 10 + kRequests; ++i) write(fmt::format("requests/{}.yaml", i), kGood);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  ASSERT_GE(child, 0);
  if (child == 0) {
    fs::current_path(path("."));
    execl(FJR_EXECUTABLE, "fjr", "batch", "requests", "--jobs", "1", "--out", "out", nullptr);
    _exit(127);
  }
  for (int i = 0; i < 5000 && !fs::exists(path("out/10/plan.json")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  const Json summary = Json::parse(contents(path("out/summary.json")));
  EXPECT_GE(summary["status"]["certified"], 1);
  EXPECT_LT(summary["status"]["certified"], kRequests);
}

// A log on a full disk, or a closed stderr: what is not told is lost, and nothing else.
TEST_F(Streams, WhatCannotBeToldEndsNothing) {
  write("good.yaml", kGood);
  write("bad.yaml", "goal: 3\n");
  const auto code_of = [&](const std::string& arguments) {
    const std::string line = fmt::format("cd '{}' && '{}' {}", path("").string(), FJR_EXECUTABLE, arguments);
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  for (const std::string nowhere : {"2>/dev/full", "2>&-"}) {
    EXPECT_EQ(code_of("plan good.yaml bad.yaml --json --out out > told " + nowhere), 2) << nowhere;
    EXPECT_EQ(Json::parse(contents(path("told")))[0]["status"], "certified") << nowhere;
    EXPECT_EQ(code_of("plna --json > told " + nowhere), 2) << nowhere;
    EXPECT_EQ(Json::parse(contents(path("told")))["status"], "bad_input") << nowhere;
    EXPECT_EQ(code_of("plan good.yaml --out out > /dev/full " + nowhere), 1) << nowhere;
  }
  EXPECT_EQ(code_of("plan good.yaml bad.yaml good.yaml --out full > /dev/full 2>&1"), 2);  // a name twice
  write("better.yaml", kGood);
  EXPECT_EQ(code_of("plan good.yaml better.yaml --out full > /dev/full"), 1);
  EXPECT_EQ(plan_json("full/better")["status"], "certified");
  EXPECT_EQ(code_of("plan good.yaml --out closed <&- >&- 2>&-"), 1);  // nobody can be told of the plan,
  EXPECT_EQ(plan_json("closed")["status"], "certified");              // which is there
  EXPECT_EQ(code_of("--help > /dev/full 2> /dev/null"), 1);
}

}  // namespace
}  // namespace fjr
