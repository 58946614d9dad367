// fjr batch as processes: what is planned, what is not planned again, and what an interruption leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Moves of a few degrees, which take some 0.3 s to plan.
const std::string kShort = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n";
const std::string kGrid = "request: short.yaml\naxes:\n  goal.q[1]: {from: 0.21, to: 0.23, count: 3}\n";
const std::vector<std::string> kNames = {"g_0.21", "g_0.22", "g_0.23"};
const std::string kLong = "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n";

class Batch : public Cli {
 protected:
  Json summary(const std::string& part = "") const {
    return Json::parse(contents(path("out") / ("summary" + part + ".json")));
  }
  std::vector<std::string> all_rows(const std::string& key, const std::string& part = "") const {
    std::vector<std::string> values;
    const Json whole = summary(part);
    for (const Json& row : whole["rows"]) values.push_back(row[key]);
    return values;
  }
  fs::path plan_file(const std::string& name) const { return path("out") / name / "plan.json"; }

  static bool within_a_minute(const std::function<bool()>& happens) {
    for (int i = 0; i < 30000; ++i) {
      if (happens()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  // Has begun to plan: it has a handler for SIGTERM.
  static bool listens(pid_t process) {
    std::istringstream text(contents("/proc/" + std::to_string(process) + "/status"));
    for (std::string word; text >> word;) {
      if (word == "SigCgt:") return text >> word && (std::stoull(word, nullptr, 16) >> (SIGTERM - 1)) % 2 == 1;
    }
    return false;
  }

  // Waits until `count` of them plan.
  static std::vector<pid_t> workers_of(pid_t batch, std::size_t count) {
    std::vector<pid_t> workers;
    EXPECT_TRUE(within_a_minute([&] {
      workers = children_of(batch);
      return workers.size() == count && std::all_of(workers.begin(), workers.end(), listens);
    }));
    return workers;
  }
};

// What other settings came to is planned again.
TEST_F(Batch, SettingsOfTheSearchCountAsTheRequestDoes) {
  write("short.yaml", kShort);
  write("settings.yaml", "follow: {most: 4}\n");
  const auto planned = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"batch", "short.yaml", "--out", "out", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments).exit_code, 0);
    return summary()["planned"].get<int>();
  };
  EXPECT_EQ(planned({"--settings", "settings.yaml"}), 1);
  EXPECT_EQ(plan_json("out/short")["settings"], (Json{{"follow.most", 4}}));
  EXPECT_EQ(planned({"--settings", "settings.yaml"}), 0);
  EXPECT_EQ(planned({}), 1);
  EXPECT_FALSE(plan_json("out/short").contains("settings"));
}

// What is written is what `fjr plan` writes; the second time nothing is.
TEST_F(Batch, AGridIsPlannedOnce) {
  write("short.yaml", kShort);
  write("g.yaml", kGrid);
  const Result first = run({"batch", "g.yaml", "--out", "out", "--json", "-q"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.err, "");
  EXPECT_EQ(first.out, contents(path("out/summary.json")));
  EXPECT_EQ(all_rows("name"), kNames);
  EXPECT_EQ(summary()["status"], (Json{{"certified", 3}}));
  EXPECT_EQ(summary()["planned"], 3);

  const Json row = summary()["rows"][2];
  ASSERT_EQ(run({"plan", "out/g_0.23/g_0.23.yaml", "--out", "alone"}).exit_code, 0);
  EXPECT_EQ(contents(path("out/g_0.23/trajectory.csv")), contents(path("alone/trajectory.csv")));
  Json alone = plan_json("alone"), batch = plan_json("out/g_0.23");
  EXPECT_EQ(row["time"], batch["timing"]["total"]);
  alone.erase("timing");
  batch.erase("timing");
  EXPECT_EQ(alone, batch);
  EXPECT_EQ(row["duration"], alone["duration"]);
  EXPECT_EQ(row["objective"], alone["objective"]["total"]);
  EXPECT_EQ(row["terms"], alone["objective"]["terms"]);
  EXPECT_EQ(row["iterations"], alone["solver"]["iterations"]);
  EXPECT_EQ(row["axes"], (Json{{"goal.q[1]", 0.23}}));

  const std::string table = contents(path("out/summary.csv"));
  EXPECT_THAT(table, StartsWith("# unit.axes.goal.q[1]: rad\n# unit.duration: s\n# unit.terms."));
  EXPECT_THAT(table, HasSubstr("\n# unit.terms.effort: N^2 m^2 s\n"));
  EXPECT_THAT(table, HasSubstr("\nname,axes.goal.q[1],status,reason,duration,objective,terms."));
  EXPECT_EQ(summary()["units"]["terms.energy"], "J");
  const auto written = fs::last_write_time(plan_file("g_0.21"));
  fs::remove(path("out/g_0.22/trajectory.csv"));
  EXPECT_EQ(run({"batch", "g.yaml", "--out", "out", "--report"}).exit_code, 0);
  for (const std::string& name : kNames) EXPECT_TRUE(fs::exists(path("out") / name / "report.html"));
  EXPECT_EQ(summary()["planned"], 1);
  EXPECT_EQ(summary()["finished_earlier"], 2);
  EXPECT_EQ(fs::last_write_time(plan_file("g_0.21")), written);
  EXPECT_TRUE(fs::exists(path("out/g_0.22/trajectory.csv")));
}

// What is no plan costs its own request, which is planned again, and no other.
TEST_F(Batch, ADamagedPlanIsPlannedAgain) {
  write("short.yaml", kShort);
  write("g.yaml", kGrid);
  const std::vector<std::string> words = {"batch", "g.yaml", "--out", "out", "-q"};
  ASSERT_EQ(run(words).exit_code, 0);
  const Json whole = plan_json("out/g_0.22");
  for (const char* field : {"objective", "certificate", "duration", "resolved_request"}) {
    Json damaged = whole;
    damaged[field] = Json::array();
    write("out/g_0.22/plan.json", damaged.dump());
    const Result again = run(words);
    EXPECT_EQ(again.exit_code, 0) << field << again.err;
    EXPECT_EQ(summary()["planned"], 1) << field;
    EXPECT_EQ(summary()["finished_earlier"], 2) << field;
  }
}

TEST_F(Batch, WhatWasFinishedBeforeAKillIsNotPlannedAgain) {
  write("a.yaml", kShort);
  write("b.yaml", kLong);
  const std::vector<std::string> words = {"batch", "a.yaml", "b.yaml", "--out", "out", "--jobs", "1"};
  const pid_t batch = start(words);
  ASSERT_TRUE(within_a_minute([&] { return fs::exists(plan_file("a")) && fs::exists(path("out/b")); }));
  const std::vector<pid_t> workers = workers_of(batch, 1);
  kill(batch, SIGKILL);
  EXPECT_EQ(finish(batch).exit_code, -1);
  for (const pid_t worker : workers) EXPECT_TRUE(within_a_minute([&] { return kill(worker, 0) != 0; }));
  EXPECT_FALSE(fs::exists(plan_file("b"))) << "a worker outlived the batch";
  EXPECT_FALSE(fs::exists(path("out/summary.json")));

  const auto written = fs::last_write_time(plan_file("a"));
  write("b.yaml", kShort);
  ASSERT_EQ(run(words).exit_code, 0);
  EXPECT_EQ(summary()["status"], (Json{{"certified", 2}}));
  EXPECT_EQ(summary()["finished_earlier"], 1);
  EXPECT_EQ(summary()["planned"], 1);
  EXPECT_EQ(fs::last_write_time(plan_file("a")), written);
}

TEST_F(Batch, SigtermLeavesWhatCanBeResumed) {
  for (const char* name : {"a.yaml", "b.yaml", "c.yaml"}) write(std::string("requests/") + name, kLong);
  const pid_t batch = start({"batch", "requests", "--out", "out", "--jobs", "2"});
  (void)workers_of(batch, 2);
  kill(batch, SIGTERM);
  EXPECT_EQ(finish(batch).exit_code, 5);
  EXPECT_EQ(summary()["status"], (Json{{"cancelled", 3}}));
  EXPECT_EQ(summary()["rows"][2]["reason"], "interrupted before it was started");
  EXPECT_FALSE(fs::exists(path("out/c")));
  EXPECT_EQ(plan_json("out/a")["status"], "cancelled");
  EXPECT_FALSE(fs::exists(path("out/a/trajectory.csv")));

  // All of them are begun again.
  EXPECT_EQ(run({"batch", "requests", "--out", "out", "--deadline", "1e-9"}).exit_code, 5);
  EXPECT_EQ(summary()["status"], (Json{{"deadline", 3}}));
  EXPECT_EQ(summary()["planned"], 3);
}

TEST_F(Batch, ShardsSideBySideMakeOneWhole) {
  write("short.yaml", kShort);
  write("g.yaml", kGrid);
  write("bad.yaml", "");
  const std::vector<std::string> words = {"batch", "g.yaml", "bad.yaml", "--out", "out"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const pid_t first = start(with({"--shard", "1/2", "--jobs", "1"})), second = start(with({"--shard", "2/2"}));
  EXPECT_EQ(finish(first).exit_code, 2);
  EXPECT_EQ(finish(second).exit_code, 0);
  EXPECT_THAT(all_rows("name", ".1-of-2"), ElementsAre("bad", "g_0.22"));
  EXPECT_THAT(all_rows("name", ".2-of-2"), ElementsAre("g_0.21", "g_0.23"));
  EXPECT_TRUE(fs::exists(path("out/summary.2-of-2.csv")));
  EXPECT_FALSE(fs::exists(path("out/summary.csv")));

  EXPECT_EQ(run(words).exit_code, 2);
  EXPECT_EQ(summary()["planned"], 0);
  EXPECT_EQ(summary()["finished_earlier"], 3);
  EXPECT_EQ(summary()["status"], (Json{{"certified", 3}, {"bad_input", 1}}));
}

TEST_F(Batch, ACrashCostsOneRequest) {
  write("a.yaml", kLong);
  write("b.yaml", "");
  const pid_t batch = start({"batch", "a.yaml", "b.yaml", "--out", "out", "--jobs", "1"});
  for (const pid_t worker : workers_of(batch, 1)) kill(worker, SIGKILL);
  EXPECT_EQ(finish(batch).exit_code, 2);
  EXPECT_EQ(summary()["rows"][0]["status"], "failed");
  EXPECT_THAT(summary()["rows"][0]["reason"], HasSubstr("ended by signal 9"));
  EXPECT_EQ(summary()["rows"][1]["status"], "bad_input");
}

TEST_F(Batch, BadRequestsAreRowsAndDoNotStopTheOthers) {
  write("requests/bad.yaml", "start: {q: [0, 0]}\ngoal: {q: [9, 0]}\n");
  write("requests/broken.yml", "{");
  write("requests/good.yaml", kLong);
  write("requests/notes.txt", "no request");
  const Result result = run({"batch", "requests", "none.yaml", "--out", "out", "--deadline", "1e-9"});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 3) << result.err;
  EXPECT_THAT(result.err,
              HasSubstr("fjr: requests/bad.yaml: goal.q[0]: 9 rad is outside [-3.2, 3.2]; angles are in rad"));
  EXPECT_THAT(result.err, HasSubstr("fjr: none.yaml: no such file\n"));
  EXPECT_THAT(all_rows("name"), ElementsAre("bad", "broken", "good", "none"));
  EXPECT_THAT(all_rows("status"), ElementsAre("bad_input", "bad_input", "deadline", "bad_input"));
  EXPECT_EQ(plan_json("out/bad")["reason"], summary()["rows"][0]["reason"]);
  EXPECT_EQ(plan_json("out/bad")["field"], "goal.q[0]");
  EXPECT_TRUE(plan_json("out/none")["field"].is_null());
  EXPECT_EQ(run({"batch", "requests/bad.yaml", "--out", "only"}).exit_code, 2);
}

TEST_F(Batch, EarlierResultsOutliveWhatIsRefusedOrCrashes) {
  write("a.yaml", kShort);
  ASSERT_EQ(run({"batch", "a.yaml", "--out", "out"}).exit_code, 0);
  const std::string earlier = contents(path("out/a/trajectory.csv"));
  write("a.yaml", kShort + "gaol: 1\n");
  EXPECT_EQ(run({"batch", "a.yaml", "--out", "out"}).exit_code, 2);
  EXPECT_EQ(summary()["rows"][0]["status"], "bad_input");
  EXPECT_EQ(contents(path("out/a/trajectory.csv")), earlier);
  EXPECT_EQ(plan_json("out/a")["status"], "certified");

  write("a.yaml", kLong);
  const pid_t batch = start({"batch", "a.yaml", "--out", "out"});
  for (const pid_t worker : workers_of(batch, 1)) kill(worker, SIGKILL);
  EXPECT_EQ(finish(batch).exit_code, 1);
  EXPECT_EQ(summary()["rows"][0]["status"], "failed");  // not what the earlier plan.json says
  EXPECT_EQ(contents(path("out/a/trajectory.csv")), earlier);

  EXPECT_EQ(run({"batch", "a.yaml", "--out", "out", "--deadline", "1e-9"}).exit_code, 5);
  EXPECT_EQ(contents(path("out/a/previous/trajectory.csv")), earlier);
  write("a.yaml", kShort);
  EXPECT_EQ(run({"batch", "a.yaml", "--out", "out"}).exit_code, 0);
  EXPECT_EQ(summary()["planned"], 1);
  EXPECT_EQ(contents(path("out/a/trajectory.csv")), earlier);
}

TEST_F(Batch, AGridWithoutAxesSaysWhatIsMissing) {
  write("short.yaml", kShort);
  write("g.yaml", "request: short.yaml\n");
  const Result result = run({"batch", "g.yaml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, StartsWith("fjr: g.yaml: axes: missing: a grid names what changes"));
  EXPECT_FALSE(fs::exists(path("out")));
}

// Requests that name a robot need none of ours; one that does not is enough to stop all of them.
TEST_F(Batch, ARobotThatIsMissingIsToldOnceBeforeAnythingIsWritten) {
  write("a.yaml", kLong);
  write("b.yaml", kLong);
  write("own.yaml", "robot: mine.yaml\n" + kLong);
  fs::copy_file(FJR_SOURCE_DIR "/config/robot.yaml", path("mine.yaml"));
  fs::create_directories(path("empty"));
  setenv("FJR_CONFIG_DIR", path("empty").c_str(), 1);
  const Result result = run({"batch", "own.yaml", "a.yaml", "b.yaml", "--out", "out", "--deadline", "1e-9"});
  const Result own = run({"batch", "own.yaml", "--out", "own", "--deadline", "1e-9"});
  unsetenv("FJR_CONFIG_DIR");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "fjr: robot.yaml: not in FJR_CONFIG_DIR, " + path("empty").string() + "\n");
  EXPECT_FALSE(fs::exists(path("out")));
  EXPECT_EQ(own.exit_code, 5) << own.err;
}

TEST_F(Batch, WrongCommandLinesAreToldBeforeAnythingIsWritten) {
  write("r.yaml", kLong);
  write("again/r.yaml", kLong);
  write("summary.csv.yaml", kLong);
  write("g.yaml", "request: none.yaml\naxes: {seed: [1]}\n");
  fs::create_directories(path("empty"));
  struct Wrong {
    std::vector<std::string> words;
    std::string message;
  };
  const Wrong wrong[] = {
      {{}, "requests"},
      {{"r.yaml", "again"}, "r.yaml: two requests named 'r' would write the same files; the other one is again/r.yaml"},
      {{"r.yaml", "r.yaml"}, "two requests named 'r'"},
      {{"summary.csv.yaml"}, "names that begin with 'summary.'"},
      {{"empty"}, "empty: holds no requests"},
      {{"g.yaml"}, "none.yaml: no such file"},
      {{"r.yaml", "--shard", "3/2"}, "--shard"},
      {{"r.yaml", "--jobs", "0"}, "--jobs"},
  };
  for (const Wrong& line : wrong) {
    std::vector<std::string> words = {"batch", "--out", "out"};
    words.insert(words.end(), line.words.begin(), line.words.end());
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(words);
    EXPECT_THAT(result.err, HasSubstr(line.message));
    EXPECT_FALSE(fs::exists(path("out"))) << testing::PrintToString(words);
  }
}

}  // namespace
}  // namespace fjr
