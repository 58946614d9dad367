// The built program, run as a process: exit codes, messages, and which files exist afterwards.
#include "tests/support/cli.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "planner/nlp/linear_solver.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kGood = "start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: free\nobjective: fastest\n";

TEST_F(Cli, HelpAndVersion) {
  const Result help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* word : {"plan", "verify", "Exit codes"}) EXPECT_THAT(help.out, HasSubstr(word));
  EXPECT_EQ(run({"plan", "--help"}).exit_code, 0);
  EXPECT_EQ(run({"verify", "--help"}).exit_code, 0);
  EXPECT_EQ(run({"--version"}).out, FJR_VERSION "\n");
}

TEST_F(Cli, WrongCommandLinesAreBadInput) {
  write("good.yaml", kGood);
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"paln"},
      {"plan"},
      {"plan", "--out", "out"},
      {"plan", "good.yaml"},
      {"plan", "good.yaml", "--out", "out", "--fast"},
      {"plan", "good.yaml", "--out", "out", "--deadline", "-1"},
      {"plan", "good.yaml", "--out", "out", "--deadline", "soon"},
      {"plan", "good.yaml", "--out", "out", "--linear-solver", "none"},
      {"verify"},
      {"verify", "a.csv", "b.csv"},
  };
  for (const auto& arguments : wrong) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_NE(result.err, "") << testing::PrintToString(arguments);
    EXPECT_EQ(result.out, "") << testing::PrintToString(arguments);
  }
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Cli, SettingsOfTheSearchAreReadAndTold) {
  write("short.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.3, -0.2]}\n");
  write("settings.yaml", "continuation: {first: {fewest_intervals: 60}}\n");
  ASSERT_EQ(run({"plan", "short.yaml", "--out", "other", "--settings", "settings.yaml", "-q"}).exit_code, 0);
  EXPECT_EQ(plan_json("other")["settings"], (Json{{"continuation.first.fewest_intervals", 60}}));
  EXPECT_EQ(plan_json("other")["solver"]["stages"][0]["intervals"], 60);
  // The listed defaults, given as a file, change nothing.
  const Result listed = run({"keys", "--settings"});
  ASSERT_EQ(listed.exit_code, 0);
  write("defaults.yaml", listed.out);
  ASSERT_EQ(run({"plan", "short.yaml", "--out", "plain", "-q"}).exit_code, 0);
  ASSERT_EQ(run({"plan", "short.yaml", "--out", "same", "--settings", "defaults.yaml", "-q"}).exit_code, 0);
  EXPECT_EQ(contents(path("same/trajectory.csv")), contents(path("plain/trajectory.csv")));
  Json plain = plan_json("plain"), same = plan_json("same");
  plain.erase("timing");
  same.erase("timing");
  EXPECT_EQ(same, plain);
  EXPECT_FALSE(same.contains("settings"));
  const Json keys = Json::parse(run({"keys", "--settings", "--json"}).out);
  EXPECT_EQ(
      keys[0],
      (Json{{"key", "continuation.first.interval"}, {"unit", "s"}, {"default", 0.02}, {"least", 1e-3}, {"most", 1.0}}));
}

TEST_F(Cli, SettingsThatCannotBeAreRefusedBeforeAnythingIsPlanned) {
  write("short.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.3, -0.2]}\n");
  const auto fault_of = [&](const std::string& command, const std::string& yaml) {
    write("settings.yaml", yaml);
    const Result result = run({command, "short.yaml", "--out", "out", "--settings", "settings.yaml"});
    EXPECT_EQ(result.exit_code, 2) << yaml;
    return result.err;
  };
  for (const char* command : {"plan", "batch"}) {
    EXPECT_THAT(fault_of(command, "folow: {most: 5}\n"),
                AllOf(HasSubstr("fjr: settings.yaml: unknown key \"folow\""), HasSubstr("did you mean follow?")));
    EXPECT_EQ(fault_of(command, "follow: {most: 0}\n"), "fjr: settings.yaml: follow.most: 0 is outside [1, 100]\n");
  }
  EXPECT_THAT(run({"plan", "short.yaml", "--out", "out", "--settings", "none.yaml"}).err,
              HasSubstr("none.yaml: no such file"));
  EXPECT_FALSE(fs::exists(path("out")));
}

// Where the folder of the results is that of a plan, too.
TEST_F(Cli, NoRequestOfSeveralTakesTheFolderOfEarlierResults) {
  const std::string request = "start: {q: [0, 0]}\ngoal: {q: [0.3, -0.2]}\n";
  write("previous.yaml", request);
  write("other.yaml", request);
  const Result result = run({"plan", "previous.yaml", "other.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              HasSubstr("previous.yaml: the folder previous in --out is for the results of an earlier run"));
  EXPECT_EQ(run({"plan", "previous.yaml", "--out", "alone", "-q"}).exit_code, 0);
}

// Before anything is computed or read for it.
TEST_F(Cli, AFileThatCannotBeWrittenIsRefusedAtOnce) {
  write("plan.json", "{}");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"export", "plan", "--format", "csv", "--out"},
                                             {"simulate", "a.csv", "--out"},
                                             {"simulate", "a.csv", "--control", "executor", "--log"},
                                             {"identify", "all", "a.csv", "--out"},
                                             {"identify", "all", "a.csv", "--report"},
                                             {"robot", "new", "arm.yaml", "--out"},
                                             {"experiment", "stiffness", "--joint", "1", "--out"},
                                             {"report", "one", "two", "--out"}}) {
    const auto fault_of = [&](const std::string& file) {
      std::vector<std::string> arguments = option;
      arguments.push_back(file);
      const Result result = run(arguments);
      EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
      return result.err;
    };
    EXPECT_THAT(fault_of("not_there/b"),
                HasSubstr(option.back() + ": cannot write not_there/b: there is no folder not_there"));
    EXPECT_THAT(fault_of("/"), HasSubstr(option.back() + ": / is a folder, not a file"));
    EXPECT_THAT(fault_of("pipe"),
                HasSubstr(option.back() + ": pipe is a device or a pipe, which a file would replace"));
    EXPECT_TRUE(fs::is_fifo(path("pipe")));
    EXPECT_THAT(fault_of("plan.json"), HasSubstr(option.back() + ": plan.json belongs to a plan, and would be lost"));
  }
}

TEST_F(Cli, WhatIsNoNumberIsRefusedWithWhatIs) {
  const auto fault_of = [&](std::vector<std::string> arguments, const std::string& value) {
    arguments.push_back(value);
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    return result.err;
  };
  for (const char* value : {"nan", "inf", "-1", "x"}) {
    for (const std::vector<std::string>& option :
         std::vector<std::vector<std::string>>{{"verify", "a.csv", "--payload"},
                                               {"verify", "a.csv", "--robust"},
                                               {"export", "a.csv", "--format", "csv", "--out", "b.csv", "--tick"},
                                               {"simulate", "a.csv", "--out", "b.csv", "--hold"},
                                               {"library", "check", "l", "--away"},
                                               {"library", "check", "l", "--tolerance"},
                                               {"identify", "executed", "a.csv", "--widen"},
                                               {"request", "a.yaml", "--out", "b", "--budget"},
                                               {"executor", "--payload"}}) {
      EXPECT_THAT(fault_of(option, value), HasSubstr(option.back() + ": " + value + " is not a number "));
    }
  }
  EXPECT_THAT(fault_of({"executor", "--start"}, "nan,0"), HasSubstr("--start: nan is not a number that is finite"));
}

struct BadRequest {
  std::string name, text, message;
};
void PrintTo(const BadRequest& request, std::ostream* out) { *out << request.name; }

// kGood with one line replaced.
std::string good_but(const std::string& from, const std::string& to) {
  std::string text = kGood;
  return text.replace(text.find(from), from.size(), to);
}

const BadRequest kBadRequests[] = {
    {"empty", "", "request.yaml"},
    {"not_yaml", "goal: [1, 2\n", "request.yaml"},
    {"not_a_map", "- 1\n- 2\n", "request.yaml"},
    {"no_goal", "start: {q: [0, 0]}\n", "goal"},
    {"unknown_key", kGood + "gaol: {q: [0, 0]}\n", "gaol"},
    {"unknown_nested_key", good_but("{q: [1.2, -0.8]}", "{q: [1.2, -0.8], tpi: 3}"), "tpi"},
    {"goal_outside_limits", good_but("-0.8", "-2.7"), "goal.q[1]"},
    {"start_outside_limits", good_but("[0.0, 0.0]", "[-3.3, 0.0]"), "start.q[0]"},
    {"goal_is_a_word", good_but("-0.8", "left"), "goal.q[1]"},
    {"goal_is_nan", good_but("-0.8", ".nan"), "goal.q[1]"},
    {"three_joints", good_but("-0.8", "-0.8, 0.1"), "goal.q"},
    {"duration_is_negative", good_but("free", "-1.0"), "duration"},
    {"duration_is_too_long", good_but("free", "21"), "duration"},
    {"fastest_in_fixed_time", good_but("free", "1.0"), "objective"},
    {"unknown_objective", good_but("fastest", "elegant"), "elegant"},
    {"free_duration_without_time_weight", good_but("fastest", "{effort: 1}"), "time"},
    {"limits_are_loosened", kGood + "limits: {torque: [13, 4]}\n", "limits.torque[0]"},
    {"sample_period_is_too_long", kGood + "sample_period: 0.1\n", "sample_period"},
    {"via_time_with_free_duration", kGood + "via:\n  - {q: [0.6, 0.4], time: 0.2}\n", "via"},
    {"robot_is_missing", kGood + "robot: nowhere.yaml\n", "nowhere.yaml"},
};

class CliBadRequest : public Cli, public testing::WithParamInterface<BadRequest> {};

TEST_P(CliBadRequest, IsRefusedAndTouchesNothing) {
  write("request.yaml", GetParam().text);
  write("out/trajectory.csv", "of an earlier run");
  const Result result = run({"plan", "request.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, testing::StartsWith("fjr: "));
  EXPECT_THAT(result.err, HasSubstr(GetParam().message));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(contents(path("out/trajectory.csv")), "of an earlier run");
  EXPECT_FALSE(fs::exists(path("out/plan.json")));

  EXPECT_EQ(run({"plan", "request.yaml", "--out", "fresh"}).exit_code, 2);  // where it is no other plan's
  EXPECT_EQ(plan_json("fresh")["status"], "bad_input");
  EXPECT_EQ("fjr: " + plan_json("fresh")["reason"].get<std::string>() + "\n", result.err);
}
INSTANTIATE_TEST_SUITE_P(Requests, CliBadRequest, testing::ValuesIn(kBadRequests),
                         [](const auto& p) { return p.param.name; });

TEST_F(Cli, SaysWhatMayHaveBeenMeant) {
  write("good.yaml", kGood);
  write("key.yaml", kGood + "limts: {torque: [10, 4]}\n");
  write("word.yaml", good_but("fastest", "fastst"));
  write("degrees.yaml", good_but("[1.2, -0.8]", "[45, -30]"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"paln", "good.yaml"}, "no subcommand is called paln; did you mean plan?"},
      {{"plan", "good.yaml", "--out", "out", "--keep-uncertfied"}, "did you mean --keep-uncertified?"},
      {{"plan", "good.yaml", "--out", "out", "--linear-solver", "mups"}, "did you mean mumps?"},
      {{"experiment", "stifness", "--joint", "1", "--out", "log.csv"}, "did you mean stiffness?"},
      {{"plan", "key.yaml", "--out", "out"}, "unknown key \"limts\"; allowed: robot, start"},
      {{"plan", "key.yaml", "--out", "out"}, "did you mean limits?"},
      {{"plan", "word.yaml", "--out", "out"}, "did you mean fastest?"},
      {{"plan", "degrees.yaml", "--out", "out"},
       "goal.q[0]: 45 rad is outside [-3.2, 3.2]; angles are in rad, and 45 degrees are 0.785398 rad"},
  };
  for (const auto& [arguments, message] : wrong) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST_F(Cli, ARequestMayComeFromStandardInput) {
  write("stdin", kGood);
  const Result result = run({"plan", "-", "--out", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(plan_json()["request"], "stdin");
  write("good.yaml", kGood);
  EXPECT_EQ(run({"plan", "good.yaml", "--out", "file"}).exit_code, 0);
  EXPECT_EQ(plan_json("file")["request_hash"], plan_json()["request_hash"]);
  write("stdin", "goal: [1, 2\n");
  EXPECT_THAT(run({"plan", "-", "--out", "out"}).err, testing::StartsWith("fjr: stdin: "));
}

// A threaded BLAS starts a thread for every core, each of which keeps its core busy at first. They have ended where the
// program waits for its request; where BLAS has no threads, there never were any.
TEST_F(Cli, HasOneThreadUnlessAskedForMore) {
  ASSERT_EQ(mkfifo(path("stdin").c_str(), 0600), 0);
  const int input = open(path("stdin").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(input, 0);
  const pid_t child = start({"plan", "-", "--out", "out"});
  const std::string half = "start: {q: [0.0, 0.0]}\n";
  ASSERT_EQ(::write(input, half.data(), half.size()), static_cast<ssize_t>(half.size()));
  int unread = 1;
  for (int i = 0; i < 5000 && unread > 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_EQ(ioctl(input, FIONREAD, &unread), 0);
  }
  EXPECT_EQ(unread, 0) << "it does not read its request";
  const fs::directory_iterator threads("/proc/" + std::to_string(child) + "/task"), end;
  EXPECT_EQ(std::distance(threads, end), 1);
  close(input);
  EXPECT_THAT(finish(child).err, HasSubstr("goal"));
}

TEST_F(Cli, ExplainsARequestWithoutPlanningIt) {
  write("request.yaml", "start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nvia: [{q: [0.6, 0]}]\n");
  const Result text = run({"plan", "--explain-request", "request.yaml"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* line : {"given    goal.q ", "default  start.dq ", "default  objective ", "gentle",
                           "default  limits.torque ", "[12, 5] N m", "[1.49087, -0.788372] rad", "default  via[0].dq ",
                           "default  sample_period ", "0.001 s", "default  seed "}) {
    EXPECT_THAT(text.out, HasSubstr(line));
  }
  const Result json = run({"plan", "--explain-request", "request.yaml", "--json"});
  std::map<std::string, Json> keys;
  const Json all = Json::parse(json.out);
  for (const Json& key : all["keys"]) keys[key["key"]] = key;
  EXPECT_EQ(keys["objective"]["value"], "gentle");
  EXPECT_EQ(keys["objective"]["given"], false);
  EXPECT_EQ(keys["objective.effort"]["value"], "0.01");
  EXPECT_EQ(keys["duration"]["given"], true);
  EXPECT_EQ(keys["limits.motor_velocity"]["value"], "[6, 8]");
  EXPECT_EQ(keys["limits.motor_velocity"]["unit"], "rad/s");
  EXPECT_EQ(keys["goal.dq"]["value"], "[0, 0]");
  EXPECT_EQ(keys["via"]["given"], true);
  EXPECT_EQ(keys["obstacles"]["value"], "none");
  EXPECT_EQ(keys["limits.tip_speed"]["given"], false);  // what no key above it is written for applies all the same
  EXPECT_FALSE(keys.contains("goal.elbow"));            // it is for goals of the tip
  EXPECT_FALSE(keys.contains("robust.confidence"));
  EXPECT_FALSE(fs::exists(path("out")));

  write("request.yaml", "goal: {q: [1.2, -0.8]}\n");
  EXPECT_EQ(run({"plan", "--explain-request", "request.yaml"}).exit_code, 2);  // refused as it would be
}

// What is in them is checked by tests/exports, with the field's own readers.
TEST_F(Cli, PlansAndLogsAreExported) {
  write("good.yaml", kGood);
  ASSERT_EQ(run({"plan", "good.yaml", "--out", "out", "-q"}).exit_code, 0);
  for (const char* format : {"csv", "mat", "mcap", "ros2"}) {
    const Result result = run({"export", "out", "--format", format});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_GT(fs::file_size(path(result.out.substr(0, result.out.find('\n')))), 1000U) << format;
  }
  // 0.429812 s of ticks of 1 ms, from 0 to the first at or behind the end, and the names.
  const std::string csv = contents(path("out/export.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 432);
  EXPECT_EQ(csv.find('#'), std::string::npos);
  ASSERT_EQ(run({"experiment", "motor_inertia", "--joint", "1", "--out", "log.csv"}).exit_code, 0);
  EXPECT_EQ(run({"export", "log.csv", "--format", "mat"}).out, "log.export.mat\n");
  EXPECT_EQ(run({"export", "out", "--format", "mcap", "--log", "log.csv", "--out", "both.mcap"}).exit_code, 0);
  EXPECT_GT(fs::file_size(path("both.mcap")), fs::file_size(path("out/export.mcap")));
  EXPECT_EQ(run({"export", "log.csv", "--format", "ros2"}).exit_code, 2);
  EXPECT_EQ(run({"verify", "out/trajectory.csv"}).exit_code, 0);  // what was there stays as it was
}

// Files may not grow beyond 4 KiB, as on a disk that is full.
TEST_F(Cli, AnExportThatDoesNotFitReplacesNothing) {
  ASSERT_EQ(run({"experiment", "motor_inertia", "--joint", "1", "--out", "log.csv"}).exit_code, 0);
  for (const char* format : {"csv", "mat", "mcap"}) {
    const std::string file = std::string("log.export.") + format;
    write(file, "the earlier one");
    Process limited({"/bin/sh", "-c", "trap '' XFSZ; ulimit -S -f 8; exec \"$@\"", "sh", FJR_EXECUTABLE, "export",
                     "log.csv", "--format", format},
                    path("said"), path(""));
    EXPECT_NE(limited.wait(), 0) << format;
    EXPECT_THAT(limited.output(), AllOf(HasSubstr("cannot write " + file + ": "), Not(HasSubstr(file + "\n"))));
    EXPECT_EQ(contents(path(file)), "the earlier one");
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(path(""))) {
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  }
  EXPECT_EQ(run({"export", "log.csv", "--format", "mat"}).exit_code, 0);
  EXPECT_GT(fs::file_size(path("log.export.mat")), 4096U);
}

TEST_F(Cli, AnExportDoesNotReplaceItsInput) {
  ASSERT_EQ(run({"experiment", "motor_inertia", "--joint", "1", "--out", "log.csv"}).exit_code, 0);
  const std::string log = contents(path("log.csv"));
  for (const char* same : {"log.csv", "./log.csv"}) {
    const Result result = run({"export", "log.csv", "--format", "csv", "--out", same});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, fmt::format("fjr: --out: {} would overwrite the input log.csv; name a file that is not an "
                                      "input\n",
                                      same));
  }
  EXPECT_EQ(contents(path("log.csv")), log);
  EXPECT_EQ(run({"export", "log.csv", "--format", "csv", "--out", "other.csv"}).exit_code, 0);
  EXPECT_EQ(run({"export", "log.csv", "--format", "csv", "--out", "other.csv"}).exit_code, 0);  // earlier exports are
}

// A robot or a request that is named by mistake is there afterwards as it was.
TEST_F(Cli, FilesOfAnotherKindAreNotReplaced) {
  ASSERT_EQ(run({"experiment", "motor_inertia", "--joint", "1", "--out", "log.csv"}).exit_code, 0);
  write("mine.yaml", "robot: something\n");
  const auto refused = [&](const std::vector<std::string>& words) {
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("mine.yaml is there, and would be lost"));
    EXPECT_TRUE(contents(path("mine.yaml")) == "robot: something\n");
  };
  refused({"export", "log.csv", "--format", "csv", "--out", "mine.yaml"});
  refused({"identify", "motor_inertia", "log.csv", "--report", "mine.yaml"});
  refused({"report", "a", "b", "--out", "mine.yaml"});
  refused({"simulate", "log.csv", "--out", "mine.yaml"});
}

// The plan that was there, and everything else in its folder, stays as it was.
TEST_F(Cli, AFolderInTheWayOfAFileOfAPlanIsToldBeforehand) {
  write("reach.yaml", kGood);
  ASSERT_EQ(run({"plan", "reach.yaml", "--out", "out"}).exit_code, 0);
  const std::string before = contents(path("out/plan.json"));
  fs::create_directory(path("out/report.html"));
  const Result result = run({"plan", "reach.yaml", "--out", "out", "--report"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("out/report.html: is a folder where a file of the plan is written: move it away"));
  EXPECT_EQ(contents(path("out/plan.json")), before);
  EXPECT_FALSE(fs::exists(path("out/.fjr-pending")));
  fs::remove(path("out/report.html"));
  EXPECT_EQ(run({"plan", "reach.yaml", "--out", "out", "--report"}).exit_code, 0);
}

TEST_F(Cli, RowsThatWereEditedAreExportedWithAWarning) {
  write("reach.yaml", kGood);
  ASSERT_EQ(run({"plan", "reach.yaml", "--out", "out"}).exit_code, 0);
  EXPECT_EQ(run({"export", "out", "--format", "csv"}).err, "");
  EXPECT_EQ(run({"report", "out"}).err, "");
  std::string rows = contents(path("out/trajectory.csv"));
  const std::size_t line = rows.find("\n0.2,") + 1, torque = rows.rfind(',', rows.find('\n', line));
  rows.insert(torque + (rows[torque + 1] == '-' ? 2 : 1), "1");  // of motor 2, some way through: 4.9 becomes 14.9
  write("out/trajectory.csv", rows);
  const auto is_told = HasSubstr("fjr: warning: out: plan.json says that it is certified, and the rows are not: ");
  EXPECT_THAT(run({"export", "out", "--format", "csv"}).err, is_told);
  EXPECT_THAT(run({"report", "out"}).err, is_told);
}

TEST_F(Cli, AMisspeltOptionIsNamedWhereAnotherOneIsMissing) {
  EXPECT_THAT(run({"export", "out", "--fromat", "csv"}).err,
              HasSubstr("no option is called --fromat; did you mean --format?"));
}

TEST_F(Cli, AMissingRequestIsBadInput) {
  const Result result = run({"plan", "none.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("none.yaml"));
  EXPECT_EQ(plan_json()["status"], "bad_input");
}

TEST_F(Cli, JsonOfARefusalIsTheOnlyThingOnStdout) {
  write("request.yaml", "");
  const Result result = run({"plan", "request.yaml", "--out", "out", "--json"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(Json::parse(result.out), plan_json());
}

TEST_F(Cli, RequestsOfOneNameAreRefusedBeforeAnythingIsWritten) {
  write("a/reach.yaml", kGood);
  write("b/reach.yaml", kGood);
  const Result result = run({"plan", "a/reach.yaml", "b/reach.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("two requests named 'reach'"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Cli, ResultsNeverLeaveTheFolder) {
  write("good.yaml", kGood);
  EXPECT_EQ(run({"plan", "good.yaml", "..", "--out", "out"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(Cli, AnOutputFolderThatIsAFileIsBadInput) {
  write("good.yaml", kGood);
  write("out", "a file");
  const Result result = run({"plan", "good.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("out"));
  EXPECT_EQ(contents(path("out")), "a file");
}

TEST_F(Cli, OneBadRequestDoesNotStopTheOthersAndTheLargestCodeWins) {
  write("bad.yaml", "");
  write("good.yaml", kGood);
  const Result result = run({"plan", "bad.yaml", "good.yaml", "--out", "out", "--json", "--deadline", "1e-9"});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_EQ(plan_json("out/bad")["status"], "bad_input");
  EXPECT_EQ(plan_json("out/good")["status"], "deadline");
  EXPECT_EQ(Json::parse(result.out), Json::array({plan_json("out/bad"), plan_json("out/good")}));
  EXPECT_FALSE(fs::exists(path("out/good/trajectory.csv")));
}

// The folder appears after the program has begun to listen for signals.
// A plan with several starts and refinements: the same request gives the same bytes, and plan.json apart from timing.
TEST_F(Cli, TheSameRequestGivesTheSameFiles) {
  write("move.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\nduration: 0.6\nobjective: gentle\n");
  std::string told;
  for (const char* out : {"first", "second"}) {
    const Result result = run({"plan", "move.yaml", "--out", out, "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("certified"));
    told = result.out;
    EXPECT_EQ(result.err, "");
    const Result check = run({"verify", std::string(out) + "/trajectory.csv"});
    EXPECT_EQ(check.exit_code, 0) << check.out;
  }
  EXPECT_EQ(contents(path("first") / "trajectory.csv"), contents(path("second") / "trajectory.csv"));
  Json first = plan_json("first"), second = plan_json("second");
  const Json& minima = first["solver"]["minima"];
  ASSERT_GT(minima.size(), 1U) << "of twelve starts";
  EXPECT_THAT(told, HasSubstr(fmt::format("\n  minima      {} met, from {:.6g} to {:.6g} (", minima.size(),
                                          minima.front().get<double>(), minima.back().get<double>())));
  first.erase("timing");
  second.erase("timing");
  EXPECT_EQ(first, second);
}

// All solvers of the linear systems find the same minimum; their rounding differs.
TEST_F(Cli, TheLinearSolverIsAMatterOfSpeed) {
  write("move.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\nobjective: fastest\n");
  setenv("FJR_HSL", FJR_FAKE_HSL, 1);
  for (const char* solver : {"stage", "mumps", "ma27"}) {
    const Result result = run({"plan", "move.yaml", "--out", solver, "--linear-solver", solver});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    // The user's own library is used for ma27, and for nothing else.
    EXPECT_EQ(result.err.find("fake HSL: ") != std::string::npos, std::string("ma27") == solver) << result.err;
  }
  unsetenv("FJR_HSL");
  // Meshes differ where an error is at its tolerance, and then the minima that are come to: measured up to 5e-4 of the
  // duration.
  const double mumps = plan_json("mumps")["duration"];
  for (const char* solver : {"stage", "ma27"}) {
    EXPECT_NEAR(plan_json(solver)["duration"].get<double>(), mumps, 1e-3 * mumps) << solver;
  }
}

TEST_F(Cli, AMissingHslLibraryIsToldAtOnce) {
  write("good.yaml", kGood);
  const auto refusal = [&](const std::string& library, const std::string& solver) {
    setenv("FJR_HSL", library.c_str(), 1);
    const Result result = run({"plan", "good.yaml", "--out", "out", "--linear-solver", solver});
    unsetenv("FJR_HSL");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(fs::exists(path("out")));
    return result.err;
  };
  EXPECT_THAT(refusal("/nowhere/libhsl.so", "ma57"), AllOf(HasSubstr("/nowhere/libhsl.so"), HasSubstr("FJR_HSL")));
  if (!what_is_missing("ma27").empty()) {  // else this machine has one
    EXPECT_THAT(refusal("", "ma27"), AllOf(HasSubstr("libhsl.so"), HasSubstr("FJR_HSL=")));
  }
  EXPECT_THAT(refusal(FJR_FAKE_HSL, "ma97"), AllOf(HasSubstr("ma97"), HasSubstr("ma97_factor_d")));
}

// Whatever ends a run, the certified plan that was there before is still there.
TEST_F(Cli, AnEarlierPlanOutlivesWhateverComesAfterIt) {
  write("good.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n");
  ASSERT_EQ(run({"plan", "good.yaml", "--out", "out", "--report"}).exit_code, 0);
  const std::string earlier = contents(path("out/trajectory.csv")), earlier_plan = contents(path("out/plan.json"));
  const auto untouched = [&] {
    return contents(path("out/trajectory.csv")) == earlier && contents(path("out/plan.json")) == earlier_plan &&
           fs::exists(path("out/report.html")) && fs::exists(path("out/solution.cbor"));
  };
  write("typo.yaml", kGood + "gaol: {q: [0, 0]}\n");
  write("contradiction.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, 0]}\nlimits: {torque: [5, 5]}\n");
  for (const char* request : {"typo.yaml", "missing.yaml", "contradiction.yaml"}) {
    const Result result = run({"plan", request, "--out", "out"});
    EXPECT_EQ(result.exit_code, 2) << request;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(untouched()) << request;
  }
  EXPECT_EQ(run({"request", "typo.yaml", "--out", "out", "--find", "0.1"}).exit_code, 1);  // nobody serves
  EXPECT_EQ(run({"request", "missing.yaml", "--out", "out"}).exit_code, 2);
  EXPECT_TRUE(untouched());

  write("long.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n");  // seconds
  const pid_t killed = start({"plan", "long.yaml", "--out", "out"});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(killed, SIGKILL);
  (void)finish(killed);
  EXPECT_TRUE(untouched());

  const Result late = run({"plan", "long.yaml", "--out", "out", "--deadline", "1e-6"});
  EXPECT_EQ(late.exit_code, 5);
  EXPECT_THAT(late.out, HasSubstr("  previous    the earlier certified plan is in out/previous\n"));
  EXPECT_EQ(plan_json()["status"], "deadline");
  EXPECT_FALSE(fs::exists(path("out/trajectory.csv")));
  EXPECT_FALSE(fs::exists(path("out/report.html")));
  EXPECT_EQ(contents(path("out/previous/trajectory.csv")), earlier);
  EXPECT_EQ(run({"report", "out/previous"}).exit_code, 0);
  const Result again = run({"plan", "long.yaml", "--out", "out", "--deadline", "1e-6", "--json"});
  EXPECT_EQ(again.err, "fjr: the earlier certified plan is in out/previous\n");
  EXPECT_EQ(contents(path("out/previous/plan.json")), earlier_plan);

  const Result warm = run({"plan", "good.yaml", "--out", "out", "--warm", "out/previous"});
  EXPECT_EQ(warm.exit_code, 0) << warm.err;
  const Json expected{{"used", true}, {"reason", nullptr}, {"from", "out/previous"}, {"away_rad", nullptr}};
  EXPECT_EQ(plan_json()["warm"], expected);
}

TEST_F(Cli, AFolderThatCannotBeWrittenIsToldBeforeAnythingIsPlanned) {
  write("good.yaml", kGood);
  const Result result = run({"plan", "good.yaml", "--out", "/proc/self"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--out: cannot write to folder /proc/self: "));
}

}  // namespace
}  // namespace fjr
