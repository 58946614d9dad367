// The parts of a batch: grids, shards, what counts as finished, the table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "planner/batch/earlier.h"
#include "planner/batch/grid.h"
#include "planner/batch/items.h"
#include "planner/batch/name_order.h"
#include "planner/batch/table.h"
#include "planner/request/request.h"
#include "planner/results/plan_json.h"
#include "planner/trajectory/trajectory.h"
#include "tests/support/arbitrary.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kRequest = "request: {start: {q: [0.0, 0.0]}, goal: {q: [0.5, 0.1]}, objective: gentle}\n";

std::vector<GridPoint> expand(const std::string& yaml) { return expand_grid(YamlNode::parse(yaml, "folder/g.yaml")); }

// The message, or "accepted".
template <class Function>
std::string complaint(Function&& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::string> names(const std::vector<GridPoint>& points) {
  std::vector<std::string> result;
  for (const GridPoint& point : points) result.push_back(point.name);
  return result;
}

TEST(Grid, EveryCombinationIsARequest) {
  const auto points = expand(kRequest + "axes:\n  goal.q[0]: {from: -0.3, to: 0.3, count: 3}\n  duration: [free, 2]\n");
  EXPECT_THAT(names(points), ElementsAre("g_-0.3_free", "g_-0.3_2", "g_0_free", "g_0_2", "g_0.3_free", "g_0.3_2"));
  const Problem problem = parse_request(points[1].yaml, points[1].name + ".yaml", ".", default_robot_file());
  EXPECT_EQ(problem.name, "g_-0.3_2");
  EXPECT_EQ(problem.goal.q, (Joints<double>{-0.3, 0.1}));
  EXPECT_EQ(problem.duration.max, 2);
  EXPECT_EQ(points[1].axes, (Json{{"goal.q[0]", -0.3}, {"duration", 2}}));
}

TEST(Grid, ValuesMayBeWordsListsAndMaps) {
  const auto points = expand(kRequest +
                             "axes: {objective: [fastest, {time: 1, effort: 0.01}, {time: 1, effort: 1}], "
                             "goal.q: [[1, 0.5]], seed: {from: 1, to: 2, count: 2}}\n");
  EXPECT_THAT(names(points), ElementsAre("g_fastest_q1_1", "g_fastest_q1_2", "g_objective2_q1_1", "g_objective2_q1_2",
                                         "g_objective3_q1_1", "g_objective3_q1_2"));
  const Problem problem = parse_request(points[5].yaml, "g.yaml", ".", default_robot_file());
  EXPECT_EQ(problem.weights.effort, 1);
  EXPECT_EQ(problem.goal.q, (Joints<double>{1, 0.5}));
  EXPECT_EQ(problem.seed, 2u);
}

// Where the requests are written, a relative path would lead elsewhere.
TEST(Grid, TheRobotIsFoundFromTheGridsFolder) {
  const auto robot_of = [](const GridPoint& point) { return YamlNode::parse(point.yaml, "p").at("robot").text(); };
  const std::string one = "request: {robot: ../r/a.yaml, goal: {q: [1, 1]}}\naxes: {seed: [1]}\n";
  EXPECT_EQ(robot_of(expand(one).front()), (fs::current_path() / "r/a.yaml").string());
  const auto two = expand(kRequest + "axes: {robot: [a.yaml, /b/c.yaml]}\n");
  EXPECT_THAT(names(two), ElementsAre("g_a", "g_c"));
  EXPECT_EQ(robot_of(two[0]), (fs::current_path() / "folder/a.yaml").string());
  EXPECT_EQ(robot_of(two[1]), "/b/c.yaml");
}

struct BadGrid {
  std::string text, message;
};

TEST(Grid, WhatMakesNoSenseIsRefusedByName) {
  const std::string axes = kRequest + "axes: ";
  const BadGrid grids[] = {
      {"axes: {seed: [1]}\n", "folder/g.yaml: request: missing: a grid has a request"},
      {kRequest, "folder/g.yaml: axes: missing: a grid names what changes from request to request, such as goal.q[0]"},
      {kRequest + "axes: {seed: [1]}\nname: x\n", "folder/g.yaml: unknown key \"name\"; allowed: request, axes"},
      {"request: none.yaml\naxes: {seed: [1]}\n", "folder/none.yaml: no such file"},
      {"request: [1]\naxes: {seed: [1]}\n", "request: must be a request, or the name of a request's file"},
      {"request: {axes: {}}\naxes: {seed: [1]}\n", "request: is a grid"},
      {axes + "[seed]\n", "axes: must be a map from paths"},
      {axes + "{}\n", "axes: must be a map from paths"},
      {axes + "{seed: 1}\n", "axes.seed: must be a list of values or {from"},
      {axes + "{seed: []}\n", "axes.seed: has no values"},
      {axes + "{seed: [1, 2, 1.0]}\n", "axes.seed: two values would be called '1'"},
      {axes + "{seed: {from: 1, to: 2}}\n", "axes.seed.count: missing"},
      {axes + "{seed: {from: 1, to: x, count: 2}}\n", "axes.seed.to: \"x\" is not a finite number"},
      {axes + "{seed: {from: 1, to: 2, count: 0}}\n", "axes.seed.count: 0 is outside [1, 100000]"},
      {axes + "{seed: {from: 1, to: 1, count: 2}}\n", "axes.seed: two values would be called '1'"},
      {axes + "{seed: {from: 1, to: 2, step: 1}}\n", "axes.seed: unknown key \"step\"; allowed: from, to, count"},
      {axes + "{gaol.q: [[1, 1]]}\n", "axes.gaol.q: the request has no \"gaol\""},
      {axes + "{\"goal.q[2]\": [1]}\n", "axes.goal.q[2]: the request's goal/q has no \"2\""},
      {axes + "{goal.q.0: [1]}\n", "axes.goal.q.0: the request's goal/q is no map"},
      {axes + "{\"goal[0]\": [1]}\n", "axes.goal[0]: the request's goal is no list"},
      {axes + "{objective.effort: [1]}\n", "axes.objective.effort: the request's objective is no map"},
      {axes + "{goal..q: [1]}\n", "axes.goal..q: is not the path of a value, such as goal.q[0]"},
      {axes + "{goal.q: [[1, 1]], \"goal.q[1]\": [1]}\n", "axes.goal.q[1]: lies within the axis goal.q"},
      {axes + "{seed: {from: 1, to: 400, count: 400}, duration: {from: 1, to: 2, count: 400}}\n",
       "axes: more than the 100000 requests allowed"},
      {axes + "{objective: [" + std::string(200, 'x') + "]}\n", "has more than 200 characters"},
  };
  for (const BadGrid& grid : grids) {
    EXPECT_THAT(complaint([&] { expand(grid.text); }), HasSubstr(grid.message)) << grid.text;
  }
}

RC_GTEST_PROP(GridProperty, EquidistantValuesAreWhatTheirNameSays, ()) {
  const double from = between(-5, 5), to = between(-5, 5);
  const auto count = *rc::gen::inRange<std::size_t>(2, 40);
  const std::vector<double> values = equidistant(from, to, count);
  RC_ASSERT(values.size() == count);
  RC_ASSERT(values.front() == from);
  RC_ASSERT(values.back() == to);
  const double step = (to - from) / static_cast<double>(count - 1);
  // Rounded to 12 digits: half a unit in the last of them for each of two neighbours.
  for (std::size_t i = 1; i < count; ++i) RC_ASSERT(std::abs(values[i] - values[i - 1] - step) < 1.1e-11);
}

// A random grid: as many points as combinations, every name once and fit for a file, every value where it belongs.
RC_GTEST_PROP(GridProperty, PointsAreTheProductOfTheAxes, ()) {
  const std::vector<std::string> paths = {"goal.q[0]", "goal.q[1]", "duration", "seed", "limits.torque[0]"};
  std::string yaml = "request: {start: {q: [0, 0]}, goal: {q: [1, 1]}, limits: {torque: [9, 4]}}\naxes:\n";
  std::size_t product = 1;
  const auto first = *rc::gen::inRange<std::size_t>(0, paths.size());
  const auto axes = *rc::gen::inRange<std::size_t>(1, 4);
  for (std::size_t i = 0; i < axes; ++i) {
    const auto values =
        *rc::gen::unique<std::vector<int>>(*rc::gen::inRange<std::size_t>(1, 5), rc::gen::inRange(-1000, 1000));
    yaml += "  " + paths[(first + i) % paths.size()] + ": [";
    for (const int value : values) yaml += std::to_string(value) + "e-3, ";
    yaml += "]\n";
    product *= values.size();
  }
  const auto points = expand(yaml);
  RC_ASSERT(points.size() == product);
  std::set<std::string> seen;
  for (const GridPoint& point : points) {
    RC_ASSERT(seen.insert(point.name).second);
    RC_ASSERT(point.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789._+-") == std::string::npos);
    const YamlNode request = YamlNode::parse(point.yaml, point.name);
    for (const auto& [path, value] : point.axes.items()) {
      const YamlNode node = path == "goal.q[0]"   ? request.at("goal").at("q").items()[0]
                            : path == "goal.q[1]" ? request.at("goal").at("q").items()[1]
                            : path == "duration"  ? request.at("duration")
                            : path == "seed"      ? request.at("seed")
                                                  : request.at("limits").at("torque").items()[0];
      RC_ASSERT(node.number("1") == value.get<double>());
    }
  }
}

// Fuzzed text is expanded or refused, and whatever is expanded is YAML.
RC_GTEST_PROP(GridProperty, BrokenGridsAreRefusedAndNothingElse, ()) {
  std::string yaml = kRequest + "axes:\n  goal.q[0]: {from: 0.1, to: 0.9, count: 3}\n  seed: [1, 2]\n";
  const std::vector<std::string> pieces = {"[", "]",   "{",     "}", ":",    ",", ".",    "\"",
                                           "-", "9",   "\n",    " ", "goal", "q", "from", "~",
                                           "/", "[0]", "1e400", "!", "\x80", "#", "robot"};
  const int changes = *rc::gen::inRange(1, 6);
  for (int i = 0; i < changes; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, yaml.size());
    const auto length = *rc::gen::inRange<std::size_t>(0, 4);
    yaml.replace(at, length, *rc::gen::elementOf(pieces));
  }
  try {
    const auto points = expand(yaml);
    RC_CLASSIFY(true, "expanded");
    RC_ASSERT(!points.empty());
    for (std::size_t i = 0; i < std::min<std::size_t>(points.size(), 3); ++i) {
      (void)YamlNode::parse(points[i].yaml, points[i].name);
    }
  } catch (const InputError& error) {
    RC_ASSERT(std::string(error.what()).size() > 5);
  }
}

// ---- order ----

TEST(NameOrder, NumbersCountAsNumbers) {
  std::vector<std::string> names = {"g_10",  "g_9",   "g_-0.3", "g_fast", "g_-0.15", "g_0.25", "g_1e-05", "g_2_10",
                                    "g_2_9", "g_007", "g_7",    "a-2",    "a-10",    "g",      "g_1e999", "g_-"};
  std::sort(names.begin(), names.end(), comes_before);
  EXPECT_THAT(names, ElementsAre("a-2", "a-10", "g", "g_-0.3", "g_-0.15", "g_1e-05", "g_0.25", "g_2_9", "g_2_10",
                                 "g_007", "g_7", "g_9", "g_10", "g_-", "g_1e999", "g_fast"));
}

// What std::sort asks for; different names are never equal, so that a shard is the same everywhere.
RC_GTEST_PROP(NameOrderProperty, IsATotalOrder, ()) {
  std::vector<std::string> names;
  for (int i = 0; i < 3; ++i)
    names.push_back(*rc::gen::container<std::string>(rc::gen::elementOf(std::string("01-_.e"))));
  const auto &a = names[0], &b = names[1], &c = names[2];
  RC_ASSERT(comes_before(a, b) + comes_before(b, a) == (a != b));
  RC_ASSERT(!comes_before(a, b) || !comes_before(b, c) || comes_before(a, c));
}

// ---- shards ----

RC_GTEST_PROP(ShardProperty, EveryItemIsInExactlyOnePart, ()) {
  const auto items = *rc::gen::inRange<std::size_t>(0, 60);
  const auto parts = *rc::gen::inRange<std::size_t>(1, 12);
  std::vector<BatchItem> all(items);
  for (std::size_t i = 0; i < items; ++i) all[i].name = std::to_string(i);
  std::multiset<std::string> seen;
  for (std::size_t part = 1; part <= parts; ++part) {
    const auto mine = shard_of(all, {part, parts});
    RC_ASSERT(mine.size() <= items / parts + 1);
    for (const BatchItem& item : mine) seen.insert(item.name);
  }
  RC_ASSERT(seen.size() == items);
  RC_ASSERT(std::set<std::string>(seen.begin(), seen.end()).size() == items);
}

TEST(Shard, IsOneOfSeveral) {
  EXPECT_EQ(parse_shard("3/8").index, 3u);
  EXPECT_EQ(parse_shard("3/8").count, 8u);
  for (const char* text : {"", "1", "0/4", "5/4", "1/0", "-1/4", "1/4x", "1 / 4", "a/b", "1/", "1/100001"}) {
    EXPECT_THAT(complaint([&] { parse_shard(text); }), HasSubstr("--shard")) << text;
  }
}

// ---- what counts as finished ----

class Earlier : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    trajectory_.samples = {{.time = 0, .state = {}, .torque = {}}, {.time = 1, .state = {}, .torque = {}}};
    trajectory_.metadata = {{"request_hash", problem_.request_hash}, {"robot_hash", hash_}, {"rows", "2"}};
    plan_["request_hash"] = problem_.request_hash;
    plan_["robot_hash"] = hash_;
    plan_["status"] = "certified";
    plan_["resolved_request"]["task"] = Json::object();
    plan_["via_times"] = Json::array();
    plan_["duration"] = 1.0;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void store(const std::string& plan) const { std::ofstream(folder_ / "plan.json") << plan; }
  // Of plan_ and trajectory_.
  bool finished(bool want_uncertified = false) const {
    store(plan_.dump());
    write_csv(trajectory_, folder_ / "trajectory.csv");
    return finished_earlier(problem_, files_in(folder_), want_uncertified).has_value();
  }

  fs::path folder_ = fs::temp_directory_path() / ("fjr_batch_test_" + std::to_string(::getpid()));
  Problem problem_ = parse_request("start: {q: [0, 0]}\ngoal: {q: [1, 1]}\n", "r.yaml", ".", default_robot_file());
  std::string hash_ = robot_hash(problem_.robot);
  Trajectory trajectory_;
  Json plan_ = bad_input_json("r", "", "");  // for the version
};

TEST_F(Earlier, WhoAsksForAProofGetsOneAndWhoDoesNotIsNotRefusedForIt) {
  const auto finished_for = [&](bool want_proven) {
    finished();  // stores them
    return finished_earlier(problem_, files_in(folder_), false, want_proven).has_value();
  };
  EXPECT_TRUE(finished_for(false));
  EXPECT_FALSE(finished_for(true));
  plan_["certificate"]["proof"]["verdict"] = "proven";
  EXPECT_TRUE(finished_for(false));
  EXPECT_TRUE(finished_for(true));
  plan_["status"] = "uncertified";
  EXPECT_FALSE(finished_for(false));
  EXPECT_TRUE(finished_for(true));
  problem_.proven = true;  // the request says so itself
  EXPECT_TRUE(finished_for(false));
}

TEST_F(Earlier, TheSameRequestRobotAndVersionAreFinished) {
  EXPECT_FALSE(finished_earlier(problem_, files_in(folder_), false));
  EXPECT_TRUE(finished());
}

TEST_F(Earlier, AnAnswerWithOtherSettingsIsNot) {
  SearchSettings settings;
  settings.follow.most = 7;
  settings.race.last_gap = 0.01;
  const auto finished_with = [&](const SearchSettings& wanted) {
    finished();  // stores them
    return finished_earlier(problem_, files_in(folder_), false, false, wanted).has_value();
  };
  EXPECT_FALSE(finished_with(settings));
  plan_["settings"] = settings_json(settings);
  EXPECT_TRUE(finished_with(settings));
  EXPECT_FALSE(finished_with({}));
  settings.follow.most = 8;
  EXPECT_FALSE(finished_with(settings));
}

TEST_F(Earlier, AnotherRequestRobotOrVersionIsNot) {
  for (const char* key : {"request_hash", "robot_hash", "version"}) {
    const Json plan = plan_;
    plan_[key] = "other";
    EXPECT_FALSE(finished()) << key;
    plan_.erase(key);
    EXPECT_FALSE(finished()) << key;
    plan_ = plan;
  }
}

TEST_F(Earlier, ATrajectoryOfAnotherPlanOrCutShortIsNot) {
  for (const char* key : {"request_hash", "robot_hash", "rows"}) {
    const auto metadata = trajectory_.metadata;
    trajectory_.metadata[key] = "3";
    EXPECT_FALSE(finished()) << key;
    trajectory_.metadata = metadata;
  }
  ASSERT_TRUE(finished());
  const fs::path file = folder_ / "trajectory.csv";
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_FALSE(finished_earlier(problem_, files_in(folder_), false));
  fs::remove(file);
  EXPECT_FALSE(finished_earlier(problem_, files_in(folder_), false));
}

TEST_F(Earlier, APlanFileThatIsNotWholeIsNot) {
  ASSERT_TRUE(finished());
  const std::string whole = plan_.dump();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    store(whole.substr(0, length));
    EXPECT_FALSE(finished_earlier(problem_, files_in(folder_), false)) << length;
  }
  for (const char* other : {"null", "[]", "{}", "{\"status\": 1}"}) {
    store(other);
    EXPECT_FALSE(finished_earlier(problem_, files_in(folder_), false)) << other;
  }
}

TEST_F(Earlier, DeadlineAndCancelledAreNotFinal) {
  for (const char* status : {"infeasible", "not_converged", "uncertified", "bad_input"}) {
    plan_["status"] = status;
    EXPECT_TRUE(finished()) << status;
  }
  for (const char* status : {"deadline", "cancelled"}) {
    plan_["status"] = status;
    EXPECT_FALSE(finished()) << status;
  }
  plan_["status"] = "uncertified";
  EXPECT_FALSE(finished(true));  // its trajectory is wanted now and was not kept
  write_csv(trajectory_, folder_ / "trajectory.uncertified.csv");
  EXPECT_TRUE(finished(true));
}

// ---- table ----

TEST(Table, HasAColumnForEveryAxisAndTerm) {
  const BatchItem plain{"a", "a.yaml", std::nullopt, nullptr};
  const BatchItem point{"b, \"c\"", "b.yaml", "", Json{{"goal.q[0]", 0.5}, {"objective", Json{{"effort", 1}}}}};
  const Json plan = Json::parse(R"({"status": "certified", "reason": null, "duration": 0.5,
      "objective": {"total": 2, "terms": {"effort": 1.5, "time": null}}, "solver": {"iterations": 7},
      "certificate": null, "timing": {"total": 0.25}})");
  EXPECT_EQ(table_csv({make_row(plain, "failed", "two\nlines"), make_row(point, plan)}),
            "# unit.axes.goal.q[0]: rad\n# unit.duration: s\n# unit.terms.effort: N^2 m^2 s\n# unit.terms.time: s\n"
            "# unit.open_loop_error: rad\n# unit.closed_loop_error: rad\n# unit.time: s\n"
            "name,axes.goal.q[0],axes.objective,status,reason,duration,objective,terms.effort,terms.time,iterations,"
            "intervals,starts,distinct_minima,open_loop_error,closed_loop_error,time\n"
            "a,,,failed,\"two\nlines\",,,,,,,,,,,\n"
            "\"b, \"\"c\"\"\",0.5,\"{\"\"effort\"\":1}\",certified,,0.5,2,1.5,,7,,,,,,0.25\n");
}

}  // namespace
}  // namespace fjr
