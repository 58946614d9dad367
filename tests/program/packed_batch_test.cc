// fjr batch prepare, run, gather, status and unpack as processes: every request is answered once, whoever plans it, and
// whatever happens to that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "planner/store/database.h"
#include "tests/support/cli.h"
#include "tests/support/temporary_folder.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

// Moves of a few degrees, which take some 0.2 s to plan; and one that takes longer.
const std::string kShort = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n";
const std::string kLong = "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\n";

class PackedBatch : public Cli {
 protected:
  void write_grid(int count) const {
    write("short.yaml", kShort);
    write("g.yaml", "request: short.yaml\naxes:\n  goal.q[1]: {from: 0.21, to: 0.2" + std::to_string(count) +
                        ", count: " + std::to_string(count) + "}\n");
  }
  Result prepare(const std::vector<std::string>& words) const {
    std::vector<std::string> all = {"batch", "prepare", "--out", "out"};
    all.insert(all.end(), words.begin(), words.end());
    return run(all);
  }
  Json status() const { return Json::parse(run({"batch", "status", "out", "--json"}).out); }
  std::string query(const std::string& file, const std::string& statement) const {
    const Database database(path(file), Database::Access::kRead);
    Statement rows = database.query(statement);
    std::string text;
    while (rows.step()) text += rows.text(0) + " ";
    return text;
  }

  static bool within_a_minute(const std::function<bool()>& happens) {
    for (int i = 0; i < 30000; ++i) {
      if (happens()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  // Waits until the first chunk has so many answers.
  bool has_answers(int count) const {
    const fs::path file = path("out/chunks/00001.sqlite");
    return within_a_minute([&] {
      return fs::exists(file) &&
             query("out/chunks/00001.sqlite", "SELECT 1 FROM sqlite_master WHERE name = 'runs'") != "" &&
             std::stoi("0" + query("out/chunks/00001.sqlite", "SELECT sum(planned) FROM runs")) >= count;
    });
  }
};

TEST_F(PackedBatch, APlanUnpackedIsThePlanThatFjrPlanMakes) {
  write_grid(3);
  EXPECT_THAT(prepare({"g.yaml", "--chunk-size", "2"}).out, StartsWith("3 requests in 2 chunks: 3 new"));
  EXPECT_EQ(run({"batch", "status", "out", "--unfinished"}).out, "1-2\n");
  const Result first = run({"batch", "run", "out", "2", "-q"});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out, "chunk 2: 1 request, 1 planned now, 0 finished earlier\n");
  EXPECT_EQ(status()["unfinished"], Json({1}));
  EXPECT_EQ(run({"batch", "gather", "out"}).exit_code, 5);  // as of what is out of time
  EXPECT_EQ(query("out/results.sqlite", "SELECT status FROM results"), "open certified open ");

  ASSERT_EQ(run({"batch", "run", "out", "-q"}).exit_code, 0);
  EXPECT_EQ(status()["planned"], 3);
  EXPECT_EQ(status()["status"], (Json{{"certified", 3}}));
  EXPECT_EQ(query("out/results.sqlite", "SELECT name FROM results"), "g_0.21 g_0.22 g_0.23 ");
  EXPECT_EQ(query("out/results.sqlite", "SELECT \"axes.goal.q[1]\" FROM results"), "0.21 0.22 0.23 ");
  EXPECT_EQ(query("out/results.sqlite", "SELECT unit FROM units WHERE column = 'terms.energy'"), "J ");

  ASSERT_EQ(run({"batch", "unpack", "out", "g_0.23", "--out", "one"}).exit_code, 0);
  ASSERT_EQ(run({"plan", "one/g_0.23.yaml", "--out", "alone", "-q"}).exit_code, 0);
  for (const char* file : {"trajectory.csv", "solution.cbor"}) {
    EXPECT_EQ(contents(path("one") / file), contents(path("alone") / file)) << file;
  }
  Json packed = plan_json("one"), alone = plan_json("alone");
  EXPECT_NEAR(std::stod(query("out/results.sqlite", "SELECT duration FROM results WHERE name = 'g_0.23'")),
              packed["duration"].get<double>(), 1e-14);  // as text SQLite has 15 digits
  packed.erase("timing");
  alone.erase("timing");
  EXPECT_EQ(packed, alone);
  EXPECT_EQ(run({"verify", "one/trajectory.csv"}).exit_code, 0);
}

// As when a node daemon dies, and its job is started again elsewhere while the first process lives on.
TEST_F(PackedBatch, AChunkThatIsStartedTwiceIsPlannedOnce) {
  write_grid(4);
  ASSERT_EQ(prepare({"g.yaml"}).exit_code, 0);
  const std::vector<std::string> words = {"batch", "run", "out", "1", "--jobs", "1", "-q"};
  const pid_t first = start(words), second = start(words);
  EXPECT_EQ(finish(first).exit_code, 0);
  EXPECT_EQ(finish(second).exit_code, 0);
  EXPECT_EQ(status()["planned"], 4);
  EXPECT_EQ(status()["runs"], 2);
}

TEST_F(PackedBatch, WhatAKillOrASignalLeavesIsPlannedOnceMoreAndNothingElse) {
  const TemporaryFolder temporary(path("tmp"));
  write_grid(5);
  ASSERT_EQ(prepare({"g.yaml"}).exit_code, 0);
  const std::vector<std::string> words = {"batch", "run", "out", "1", "--jobs", "1", "-q"};
  const pid_t killed = start(words);
  ASSERT_TRUE(has_answers(1));
  kill(killed, SIGKILL);
  EXPECT_EQ(finish(killed).exit_code, -1);
  EXPECT_FALSE(fs::is_empty(path("tmp")));
  const int before = status()["planned"];
  const pid_t preempted = start(words);
  ASSERT_TRUE(has_answers(before + 1));
  kill(preempted, SIGTERM);
  EXPECT_EQ(finish(preempted).exit_code, 5);
  EXPECT_FALSE(status()["status"].contains("cancelled"));
  EXPECT_LT(status()["planned"], 5);
  EXPECT_EQ(finish(start(words)).exit_code, 0);
  EXPECT_EQ(status()["planned"], 5);
  EXPECT_EQ(status()["runs"], 3);
  EXPECT_TRUE(fs::is_empty(path("tmp"))) << "what the killed one had there was removed by the next";
}

// Names and chunks that somebody has changed lead neither out of the folder nor past requests.
TEST_F(PackedBatch, AnEditedManifestIsRefused) {
  write("a.yaml", kShort);
  fs::create_directories(path("victim"));
  write("victim/notes.txt", "precious");
  const auto refusal_after = [&](const std::string& change) {
    fs::remove_all(path("out"));
    EXPECT_EQ(prepare({"a.yaml"}).exit_code, 0);
    Database(path("out/manifest.sqlite"), Database::Access::kWrite).execute("UPDATE requests SET " + change);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"batch", "run", "out", "-q"}, {"batch", "status", "out"}}) {
      const Result refused = run(words);
      EXPECT_EQ(refused.exit_code, 2) << change << refused.out;
      EXPECT_THAT(refused.err, HasSubstr("the manifest was edited")) << change;
    }
    EXPECT_EQ(prepare({"a.yaml"}).exit_code, 2) << change;
  };
  for (const char* chunk : {"1000000000", "-1", "0", "NULL", "'one'"}) refusal_after(std::string("chunk = ") + chunk);
  for (const std::string name : {"../../victim", "", "..", "/tmp/x"}) refusal_after("name = '" + name + "'");
  EXPECT_TRUE(fs::exists(path("victim/notes.txt")));
}

// A node that does not see the library plans nothing, and its requests stay open for the others.
TEST_F(PackedBatch, RequestsArePlannedLaterWhereTheirLibraryIsMissing) {
  write("a.yaml", kShort);
  ASSERT_EQ(prepare({"a.yaml", "--library", "nowhere"}).exit_code, 0);
  EXPECT_EQ(run({"batch", "run", "out", "1", "-q"}).exit_code, 1);
  EXPECT_EQ(status()["status"], (Json{{"failed", 1}}));
  EXPECT_EQ(status()["unfinished"], Json({1}));
}

TEST_F(PackedBatch, ACrashedPlanIsFailedUntilItIsPlannedAgain) {
  write("a.yaml", kLong);
  ASSERT_EQ(prepare({"a.yaml"}).exit_code, 0);
  const std::vector<std::string> words = {"batch", "run", "out", "1", "-q"};
  const pid_t batch = start(words);
  std::vector<pid_t> workers;
  ASSERT_TRUE(within_a_minute([&] { return !(workers = children_of(batch)).empty(); }));
  kill(workers[0], SIGKILL);
  EXPECT_EQ(finish(batch).exit_code, 1);
  EXPECT_EQ(status()["status"], (Json{{"failed", 1}}));
  EXPECT_EQ(status()["unfinished"], Json({1}));
  EXPECT_EQ(run({"batch", "unpack", "out", "a", "--out", "one"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(path("one")));

  write("a.yaml", kShort);
  EXPECT_THAT(prepare({"a.yaml"}).out, StartsWith("1 request in 1 chunk: 0 new, 1 changed"));
  EXPECT_EQ(run(words).exit_code, 0);
  EXPECT_EQ(status()["status"], (Json{{"certified", 1}}));
}

// Answers belong to what they were asked with, and a certified plan is not lost to a request that is worse.
TEST_F(PackedBatch, ChangedRequestsAreOpenAndNewOnesAreAdded) {
  fs::copy_file(FJR_SOURCE_DIR "/config/robot.yaml", path("mine.yaml"));
  write("a.yaml", "robot: mine.yaml\n" + kShort);
  ASSERT_EQ(prepare({"a.yaml"}).exit_code, 0);
  ASSERT_EQ(run({"batch", "run", "out", "-q"}).exit_code, 0);
  ASSERT_EQ(run({"batch", "unpack", "out", "a", "--out", "before"}).exit_code, 0);

  write("mine.yaml", contents(path("mine.yaml")) + "# the same robot\n");
  write("b.yaml", "");
  EXPECT_THAT(prepare({"b.yaml", "a.yaml"}).out, StartsWith("2 requests in 2 chunks: 1 new, 1 changed"));
  EXPECT_EQ(status()["status"], (Json{{"open", 2}}));
  EXPECT_EQ(run({"batch", "run", "out", "-q"}).exit_code, 2);
  EXPECT_EQ(status()["status"], (Json{{"certified", 1}, {"bad_input", 1}}));
  EXPECT_EQ(status()["planned"], 1) << "a comment in robot.yaml makes no other robot";

  write("a.yaml", "robot: mine.yaml\nstart: {q: [0, 0]}\ngoal: {q: [9, 0]}\n");
  EXPECT_THAT(prepare({"a.yaml"}).out,
              StartsWith("2 requests in 2 chunks: 0 new, 1 changed, 0 as before, 1 not named"));
  const Result refused = run({"batch", "run", "out", "1", "-q"});
  EXPECT_EQ(refused.exit_code, 0) << "an answer it is";
  EXPECT_THAT(refused.err, HasSubstr("a.yaml: goal.q[0]: 9 rad is outside"));
  ASSERT_EQ(run({"batch", "unpack", "out", "a", "--out", "after"}).exit_code, 0);
  EXPECT_EQ(plan_json("after")["status"], "bad_input");
  EXPECT_EQ(contents(path("after/previous/trajectory.csv")), contents(path("before/trajectory.csv")));
}

// As on a disk that has lost some of it.
TEST_F(PackedBatch, AnAnswerWithoutItsRowsIsPlannedAgain) {
  write("a.yaml", kShort);
  ASSERT_EQ(prepare({"a.yaml"}).exit_code, 0);
  ASSERT_EQ(run({"batch", "run", "out", "-q"}).exit_code, 0);
  for (const std::string damage : {"DELETE FROM files", "UPDATE files SET size = size + 1",
                                   "UPDATE files SET size = -1", "UPDATE files SET size = 1000000000000000"}) {
    Database(path("out/chunks/00001.sqlite"), Database::Access::kWrite)
        .run(damage + " WHERE file = 'trajectory.csv' AND previous = 0");
    ASSERT_EQ(run({"batch", "run", "out", "1", "-q"}).exit_code, 0) << damage;
    ASSERT_EQ(run({"batch", "unpack", "out", "a", "--out", "whole"}).exit_code, 0) << damage;
    EXPECT_EQ(run({"verify", "whole"}).exit_code, 0) << damage;
    fs::remove_all(path("whole"));
  }
}

TEST_F(PackedBatch, WrongCommandLinesAreTold) {
  write("a.yaml", kLong);
  ASSERT_EQ(prepare({"a.yaml"}).exit_code, 0);
  write("broken/manifest.sqlite", "this is none, and long enough not to be taken for one that has just begun");
  struct Wrong {
    std::vector<std::string> words;
    std::string message;
  };
  const Wrong wrong[] = {
      {{"status", "nowhere"}, "nowhere: holds no manifest.sqlite: it is no packed batch"},
      {{"status", "broken"}, "manifest.sqlite: file is not a database"},
      {{"run", "out", "2"}, "chunk 2 is outside [1, 1]"},
      {{"unpack", "out", "b", "--out", "one"}, "out: holds no request \"b\""},
      {{"unpack", "out", "a", "--out", "one"}, "out: has no answer to \"a\" yet"},
      {{"prepare", "a.yaml", "--out", "out", "--starts", "2"}, "begun with other options, --linear-solver stage"},
      {{"prepare", "none.yaml", "--out", "new"}, "none.yaml: no such file"},
      {{"prepare", "a.yaml", "--out", "new", "--chunk-size", "0"}, "--chunk-size"},
  };
  for (const Wrong& line : wrong) {
    std::vector<std::string> words = {"batch"};
    words.insert(words.end(), line.words.begin(), line.words.end());
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(words);
    EXPECT_THAT(result.err, HasSubstr(line.message));
  }
  EXPECT_FALSE(fs::exists(path("new")));
  EXPECT_FALSE(fs::exists(path("one")));
}

}  // namespace
}  // namespace fjr
