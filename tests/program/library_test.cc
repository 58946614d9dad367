// fjr library: what is built is looked up, planned from and checked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/store/database.h"
#include "tests/support/cli.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

class Library : public Cli {
 protected:
  // Goals 0.04 rad apart: every goal between them is within 0.02 rad of one.
  void build() {
    write("request.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.2, -0.1]}\n");
    write("g.yaml", "request: request.yaml\naxes:\n  goal.q[0]: [0.20, 0.24]\n");
    const Result built = run({"library", "build", "g.yaml", "--out", "lib", "--json", "-q"});
    ASSERT_EQ(built.exit_code, 0) << built.err;
    EXPECT_EQ(Json::parse(built.out)["added"], 2);
  }
};

TEST_F(Library, RequestsBesideItsPlansStartFromThem) {
  build();
  const Json again = Json::parse(run({"library", "build", "g.yaml", "--out", "lib", "--json", "-q"}).out);
  EXPECT_EQ(again["before"], 2);
  EXPECT_EQ(again["added"], 0);
  const Json status = Json::parse(run({"library", "status", "lib", "--json"}).out);
  ASSERT_EQ(status.size(), 1U);
  EXPECT_EQ(status[0]["plans"], 2);
  EXPECT_EQ(status[0]["goal_rad"], Json::parse("[[0.2, 0.24], [-0.1, -0.1]]"));

  // The plan itself: nothing is left to be done but to certify it.
  write("same.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.24, -0.1]}\n");
  ASSERT_EQ(run({"plan", "same.yaml", "--out", "same", "--library", "lib", "-q"}).exit_code, 0);
  const Json same = plan_json("same");
  EXPECT_EQ(same["warm"],
            nlohmann::json::parse(R"({"used": true, "reason": null, "from": "g_0.24", "away_rad": 0.0})"));
  EXPECT_LT(same["solver"]["iterations"], 10);  // from scratch about a hundred

  // Beyond 0.02 rad, or with another limit, as without a library.
  write("far.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.3, -0.1]}\n");
  write("other.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.24, -0.1]}\nlimits: {torque: [11, 5]}\n");
  for (const char* name : {"far", "other"}) {
    ASSERT_EQ(run({"plan", std::string(name) + ".yaml", "--out", name, "--library", "lib", "-q"}).exit_code, 0);
    EXPECT_EQ(plan_json(name)["warm"]["from"], nullptr) << name;
    EXPECT_FALSE(plan_json(name)["warm"]["used"]) << name;
  }
}

TEST_F(Library, ADamagedPlanIsOfNoUseAndNoHindrance) {
  build();
  Database(path("lib/library.sqlite"), Database::Access::kWrite).execute("UPDATE plans SET solution = x'00'");
  write("same.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.24, -0.1]}\n");
  const Result planned = run({"plan", "same.yaml", "--out", "same", "--library", "lib"});
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_THAT(planned.err, HasSubstr("lib: planned from scratch, for the nearest plan cannot be read: "));
  EXPECT_FALSE(plan_json("same")["warm"]["used"]);
}

TEST_F(Library, ACheckComparesWithPlansFromScratch) {
  build();
  const Result checked = run({"library", "check", "lib", "--away", "0.005", "--json", "-q"});
  const Json told = Json::parse(checked.out);
  EXPECT_EQ(told["checked"], 2);
  // Two meshes, two sets of margins, as in warm_test: measured 2e-4 and less.
  EXPECT_LT(told["worst_excess"], 1e-3);
  EXPECT_EQ(checked.exit_code, 0);
  // How many iterations a single one takes is chance: 41 of 48 took fewer than from scratch.
  for (const Json& request : told["requests"]) EXPECT_GT(request["iterations_from_scratch"], 0);
}

TEST_F(Library, WhatIsNoneIsRefusedAndLeftAsItIs) {
  write("a.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.2, -0.1]}\n");
  const Result none = run({"plan", "a.yaml", "--out", "out", "--library", "nowhere"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("nowhere: holds no plan library"));
  std::filesystem::create_directory(path("lib"));
  write("lib/library.sqlite", "these are no tables");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"library", "build", "a.yaml", "--out", "lib", "-q"},
        std::vector<std::string>{"library", "status", "lib"}}) {
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr("library.sqlite"));
  }
  EXPECT_EQ(contents(path("lib/library.sqlite")), "these are no tables");
  EXPECT_EQ(run({"plan", "a.yaml", "--out", "out", "--library", "lib", "--warm", "x"}).exit_code, 2);
}

TEST_F(Library, GoalsThatLeaveAnAngleOpenAreNotKept) {
  write("a.yaml", "start: {q: [0, 0]}\ngoal: {q: [0.2, free]}\n");
  const Json told = Json::parse(run({"library", "build", "a.yaml", "--out", "lib", "--json", "-q"}).out);
  EXPECT_EQ(told["without_family"], 1);
  EXPECT_EQ(told["added"], 0);
}

}  // namespace
}  // namespace fjr
