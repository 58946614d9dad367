// The built program on files of trajectories and folders of plans: verify, simulate and report.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "planner/trajectory/trajectory.h"
#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

const std::string kReach = "start: {q: [0.0, 0.0]}\ngoal: {q: [1.2, -0.8]}\nduration: free\nobjective: fastest\n";

// The arm hangs still: any robot follows that.
Trajectory at_rest() {
  Trajectory trajectory;
  for (int i = 0; i <= 20; ++i) trajectory.samples.push_back({.time = i / 1000.0, .state = {}, .torque = {}});
  return trajectory;
}

TEST_F(Cli, VerifyAcceptsWhatTheRobotDoes) {
  write_csv(at_rest(), path("t.csv"));
  const Result result = run({"verify", "t.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("certified"));
  EXPECT_THAT(result.out, HasSubstr("starts at rest, ends at rest"));
  EXPECT_THAT(result.out, HasSubstr("21 rows; how many there were is not said, so some may be missing"));
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(Json::parse(run({"verify", "t.csv", "--json"}).out)["complete"].is_null());
}

TEST_F(Cli, VerifyTellsHowAFileStartsAndWhetherItIsComplete) {
  Trajectory trajectory = at_rest();
  trajectory.metadata["rows"] = "21";
  trajectory.samples.front().state.dq[0] = 0.5;
  write_csv(trajectory, path("t.csv"));
  EXPECT_THAT(run({"verify", "t.csv"}).out,
              HasSubstr("(21 rows, 0.02 s, starts MOVING, links at 0.5 and 0 rad/s, motors at 0 and 0 rad/s, ends"));
  const Json certificate = Json::parse(run({"verify", "t.csv", "--json"}).out);
  EXPECT_EQ(certificate["starts_at_rest"], false);
  EXPECT_EQ(certificate["ends_at_rest"], true);
  EXPECT_EQ(certificate["complete"], true);
}

TEST_F(Cli, VerifyProvesOnDemand) {
  Trajectory trajectory = at_rest();
  write_csv(trajectory, path("t.csv"));
  const Result proven = run({"verify", "t.csv", "--proven"});
  EXPECT_EQ(proven.exit_code, 0) << proven.out;
  EXPECT_THAT(proven.out, HasSubstr("\n  proven      at all times: open loop link at most 0.0000 counts"));
  EXPECT_TRUE(Json::parse(run({"verify", "t.csv", "--json"}).out)["proof"].is_null());
  trajectory.samples[10].state.q[0] += 2e-4;
  write_csv(trajectory, path("t.csv"));
  const Result refused = run({"verify", "t.csv", "--proven", "--json"});
  EXPECT_EQ(refused.exit_code, 4);
  const Json proof = Json::parse(refused.out)["proof"];
  EXPECT_EQ(proof["verdict"], "not_proven");
  EXPECT_THAT(proof["reason"], HasSubstr("not proven from t = 0.0"));
}

TEST_F(Cli, VerifyTellsMarginsOnDemand) {
  write_csv(at_rest(), path("t.csv"));
  const Result unknown = run({"verify", "t.csv", "--robust", "0.9"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("nothing is uncertain"));
  EXPECT_EQ(run({"verify", "t.csv", "--robust", "1"}).exit_code, 2);
  std::string robot = contents(FJR_SOURCE_DIR "/config/robot.yaml");
  const std::string stiffness = "of eq. (1)\", standard_error: ";
  robot.replace(robot.find(stiffness) + stiffness.size(), 4, "[0.01, 0.01]");
  write("robot.yaml", robot);
  const Result kept = run({"verify", "t.csv", "--robot", "robot.yaml", "--robust", "0.9"});
  EXPECT_EQ(kept.exit_code, 0) << kept.out;
  EXPECT_THAT(kept.out, HasSubstr("\n  robust      probability 0.9 over 2 uncertain parameters: links within "));
  EXPECT_THAT(kept.out, HasSubstr("not covered: link damping that is not modelled, hysteresis, temperature"));
  const Result json = run({"verify", "t.csv", "--robot", "robot.yaml", "--robust", "0.9", "--json"});
  const Json robustness = Json::parse(json.out)["robustness"];
  EXPECT_EQ(robustness["verdict"], "kept");
  EXPECT_EQ(robustness["limits"].size(), 8U);
  EXPECT_EQ(robustness["limits"][0]["tube"].size(), robustness["times"].size());
  EXPECT_TRUE(Json::parse(run({"verify", "t.csv", "--json"}).out)["robustness"].is_null());
}

TEST_F(Cli, APlanIsProvenOnDemand) {
  write("move.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\nobjective: fastest\n");
  EXPECT_EQ(run({"plan", "move.yaml", "--out", "out", "--proven"}).exit_code, 0);
  const Json proof = plan_json("out")["certificate"]["proof"];
  EXPECT_EQ(proof["verdict"], "proven");
  EXPECT_EQ(proof["until"], plan_json("out")["duration"]);
  EXPECT_EQ(proof["limits"].size(), 8U);
  write("asks.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\nobjective: fastest\nproven: true\n");
  EXPECT_EQ(run({"plan", "asks.yaml", "--out", "asked"}).exit_code, 0);
  EXPECT_EQ(plan_json("asked")["certificate"]["proof"], proof);
}

// What is proven of a task is proven segment by segment: times that belong to no segments are refused.
TEST_F(Cli, VerifyRefusesAPlanWhoseSegmentsAreNone) {
  write_csv(at_rest(), path("trajectory.csv"));
  const auto verify = [&](const std::string& via_times, const std::string& duration) {
    write("plan.json",
          R"({"resolved_request": {"task": {"path": {"corners": [[0, 0], [1e-3, 0], [0, 0]], "tolerance": 0.01}}}, )"
          R"("via_times": )" +
              via_times + R"(, "duration": )" + duration + "}");
    return run({"verify", ".", "--proven"});
  };
  EXPECT_EQ(verify("[0.01]", "0.02").exit_code, 0);
  const auto refusal = [&](const std::string& via_times, const std::string& duration) {
    const Result result = verify(via_times, duration);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(refusal("[0.03]", "0.02"), HasSubstr("plan.json: duration: 0.02 s is not later than 0.03 s"));
  EXPECT_THAT(refusal("[0]", "0.02"), HasSubstr("via_times[0]: 0 s is not later than 0 s, where the segment begins"));
  EXPECT_THAT(refusal("[]", "0.02"), HasSubstr("via_times: has 0 times, but the path has 2 segments"));
  EXPECT_THAT(refusal("[0.005, 0.01]", "0.02"), HasSubstr("via_times: has 2 times, but the path has 2 segments"));
}

TEST_F(Cli, VerifyHoldsTheRowsOfAFolderAgainstItsTask) {
  write_csv(at_rest(), path("trajectory.csv"));
  const auto verify = [&](double radius) {  // a disc beside the hanging arm
    write("plan.json", fmt::format(R"({{"resolved_request": {{"task": {{"obstacles": [{{"center": [0.3, -0.1], )"
                                   R"("radius": {}}}]}}}}, "via_times": [], "duration": 0.02}})",
                                   radius));
    return run({"verify", "."});
  };
  EXPECT_EQ(verify(0.1).exit_code, 0);
  const Result missed = verify(0.5);
  EXPECT_EQ(missed.exit_code, 4);
  EXPECT_THAT(missed.out, HasSubstr("obstacles[0] (link 1) is missed by"));
}

// A plan.json can be edited; the request that somebody has kept cannot.
TEST_F(Cli, VerifyHoldsRowsAgainstARequestWhateverPlanJsonSays) {
  const std::string from_to = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.0, 0.5]}\n";
  write("move.yaml", from_to + "via: [{q: [0.2, 0.25]}]\n");
  ASSERT_EQ(run({"plan", "move.yaml", "--out", "out"}).exit_code, 0);
  const auto verify = [&](const std::string& trajectory, const std::string& more) {
    write("asked.yaml", from_to + more);
    return run({"verify", trajectory, "--request", "asked.yaml"});
  };
  EXPECT_EQ(run({"verify", "out", "--request", "move.yaml"}).exit_code, 0);

  const Result less = verify("out", "");  // a motion by way of a point also goes from start to goal
  EXPECT_EQ(less.exit_code, 0);
  EXPECT_THAT(less.out, HasSubstr("certified against the robot's limits, and as asked.yaml asks ("));
  EXPECT_THAT(less.err, HasSubstr("planned for another request"));
  EXPECT_EQ(verify("out/trajectory.csv", "").exit_code, 0);

  const std::vector<std::pair<std::string, std::string>> missed = {
      {"via: [{q: [0.2, 0.26]}]\n", "via point 1 is missed"},
      {"duration: {max: 0.1}\n", "the motion takes"},
      {"limits: {tip_speed: 0.5}\n", "tip_speed"},
      {"payload: {mass: 0.3}\n", "payload 0.3 kg"},
      {"obstacles: [{center: [0.23, -0.66], radius: 0.035}]\n", "obstacles[0] (link 2) is missed"},
  };
  for (const auto& [more, told] : missed) {
    const Result result = verify("out", more);
    EXPECT_EQ(result.exit_code, 4) << more;
    EXPECT_THAT(result.out, HasSubstr(told));
  }

  std::string edited = contents(path("out/plan.json"));
  const std::string stiffness = "20.48";
  edited.replace(edited.find(stiffness), stiffness.size(), "10.24");
  write("out/plan.json", edited);
  EXPECT_THAT(run({"verify", "out"}).err,
              HasSubstr("robot.spring.stiffness is [10.24, 17.75], but the robot's [20.48"));

  const Result unknown = run({"verify", "out/trajectory.csv", "--request", "move.yaml"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("move: via[0].time: is free, and no plan.json with as many via points says"));
  EXPECT_EQ(run({"verify", "out", "--request", "move.yaml", "--payload", "0.1"}).exit_code, 2);
  EXPECT_THAT(verify("out", "robot: none.yaml\n").err, HasSubstr("asked.yaml: robot: no such file"));
}

TEST_F(Cli, VerifySaysWhereRowsAndPlanAreOfDifferentRequests) {
  Trajectory trajectory = at_rest();
  trajectory.metadata["request_hash"] = "abc";
  write_csv(trajectory, path("trajectory.csv"));
  const auto warnings = [&](const std::string& hash) {
    write("plan.json", R"({"request_hash": ")" + hash +
                           R"(", "resolved_request": {"task": {}}, "via_times": [], "duration": 0.02})");
    return run({"verify", "."}).err;
  };
  EXPECT_THAT(warnings("abc"), Not(HasSubstr("another request")));
  EXPECT_THAT(warnings("abc"), HasSubstr("plan.json does not say from where to where"));
  EXPECT_THAT(warnings("def"),
              HasSubstr("it was planned for another request (request_hash abc, that of plan.json is def)"));
}

// A motion that keeps its robot's limits need not be the one that plan.json tells of.
TEST_F(Cli, VerifyHoldsTheRowsOfAFolderAgainstTheRequest) {
  write("move.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.36, 0.14]}\nlimits: {torque: [9, 4]}\nobjective: fastest\n");
  ASSERT_EQ(run({"plan", "move.yaml", "--out", "out"}).exit_code, 0);
  EXPECT_EQ(run({"verify", "out"}).exit_code, 0);
  const Json honest = plan_json("out");
  const auto failure = [&](const std::function<void(Json&)>& tell) {
    Json told = honest;
    tell(told["resolved_request"]);
    write("out/plan.json", told.dump());
    const Result result = run({"verify", "out"});
    EXPECT_EQ(result.exit_code, 4) << result.out << result.err;
    return result.out;
  };
  EXPECT_THAT(failure([](Json& r) { r["limits"]["torque"] = {5.0, 4.0}; }), HasSubstr("torque of joint 1 reaches"));
  EXPECT_THAT(failure([](Json& r) { r["limits"]["tip_speed"] = 0.1; }),
              HasSubstr("the file does not say that tip_speed was limited to 0.1 m/s, as its request does"));
  EXPECT_THAT(failure([](Json& r) { r["start"]["q"][0] = 0.301; }), HasSubstr("the first row is not the start"));
  EXPECT_THAT(failure([](Json& r) { r["goal"]["q"][1] = 0.141; }), HasSubstr("the last row is not the goal"));
  EXPECT_THAT(failure([](Json& r) { r["duration"]["max"] = 0.05; }), HasSubstr("the motion takes"));

  Json longer = honest;
  longer["duration"] = honest["duration"].get<double>() + 1e-3;
  write("out/plan.json", longer.dump());
  EXPECT_THAT(run({"verify", "out"}).out, HasSubstr("the rows end at"));
  Json of_another = honest;
  of_another["robot_hash"] = "abc";
  write("out/plan.json", of_another.dump());
  EXPECT_THAT(run({"verify", "out"}).err, HasSubstr("that of plan.json is abc"));

  write("out/plan.json", honest.dump());
  const Trajectory planned = read_csv(path("out/trajectory.csv"));
  Trajectory sooner = planned;
  for (Sample& row : sooner.samples) row.time -= 0.01;
  write_csv(sooner, path("out/trajectory.csv"));
  EXPECT_THAT(run({"verify", "out"}).out, HasSubstr("the rows begin at -0.01 s, and the motion of plan.json at 0 s"));
  Trajectory unsaid = planned;  // a payload that is held nowhere but in plan.json
  unsaid.metadata.erase("payload");
  write_csv(unsaid, path("out/trajectory.csv"));
  EXPECT_EQ(run({"verify", "out"}).exit_code, 0);
  Json loaded = honest;
  loaded["robot"]["payload"]["mass"] = 0.3;
  write("out/plan.json", loaded.dump());
  EXPECT_EQ(run({"verify", "out"}).exit_code, 4);
  write_csv(planned, path("out/trajectory.csv"));

  Json either = honest;  // of several goals one will do
  either["resolved_request"]["other_goals"] = {either["resolved_request"]["goal"]};
  either["resolved_request"]["goal"]["q"] = {1.0, 1.0};
  write("out/plan.json", either.dump());
  EXPECT_EQ(run({"verify", "out"}).exit_code, 0);

  write("out/plan.json", R"({"status": "certified", "status": "certified"})");
  EXPECT_THAT(run({"verify", "out"}).err, HasSubstr("has the key \"status\" twice in one object"));
  fs::remove(path("out/plan.json"));
  const Result none = run({"verify", "out"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("out/plan.json: cannot be read: this is no folder of a plan"));
}

// In the middle of a number of its last row: it has all rows that it says it has.
TEST_F(Cli, VerifyRefusesAFileWhoseLastLineWasCut) {
  Trajectory trajectory = at_rest();
  trajectory.metadata["rows"] = "21";
  trajectory.samples.back().torque = {1e-4, 1.234e-4};
  write_csv(trajectory, path("t.csv"));
  EXPECT_EQ(run({"verify", "t.csv"}).exit_code, 0);
  fs::resize_file(path("t.csv"), fs::file_size(path("t.csv")) - 3);
  const Result cut = run({"verify", "t.csv"});
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.err, HasSubstr("does not end: the file was cut short"));
}

TEST_F(Cli, SimulateRefusesAFileThatWasCutBetweenTwoLines) {
  Trajectory trajectory = at_rest();
  trajectory.metadata["rows"] = "21";
  trajectory.samples.resize(15);
  write_csv(trajectory, path("t.csv"));
  const Result cut = run({"simulate", "t.csv"});
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.err, HasSubstr("t.csv: # rows: the file has 15 rows, but says that it had 21"));
}

TEST_F(Cli, VerifyRefusesATamperedFile) {
  Trajectory trajectory = at_rest();
  trajectory.samples[10].state.q[0] += 2e-4;  // two counts of the link encoder
  write_csv(trajectory, path("t.csv"));
  const Result result = run({"verify", "t.csv", "--json"});
  EXPECT_EQ(result.exit_code, 4);
  const Json certificate = Json::parse(result.out);
  EXPECT_EQ(certificate["verdict"], "failed");
  EXPECT_NE(certificate["failures"].size(), 0u);
}

TEST_F(Cli, VerifyRefusesWhatIsBeyondTheLimits) {
  Trajectory trajectory = at_rest();
  for (Sample& sample : trajectory.samples) sample.torque[1] = 50;
  write_csv(trajectory, path("t.csv"));
  EXPECT_EQ(run({"verify", "t.csv"}).exit_code, 4);
}

TEST_F(Cli, VerifyWarnsOfAnotherRobot) {
  Trajectory trajectory = at_rest();
  trajectory.metadata["robot_hash"] = "0123";
  write_csv(trajectory, path("t.csv"));
  const Result result = run({"verify", "t.csv", "--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("t.csv: it was planned for another robot (robot_hash 0123"));
  EXPECT_EQ(Json::parse(result.out)["verdict"], "certified");
}

// A move of a few degrees, which takes some 0.3 s to plan.
const std::string kShort = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n";

TEST_F(Cli, VerifyTakesPayloadAndLimitsFromTheFileAndNeverLooserOnes) {
  write("r.yaml", kShort + "payload: 0.1\nlimits: {torque: [8, 5], tip_speed: 0.5}\n");
  ASSERT_EQ(run({"plan", "r.yaml", "--out", "out"}).exit_code, 0);
  const std::string file = contents(path("out/trajectory.csv"));
  EXPECT_THAT(file, HasSubstr("# limits.tip_speed: 0.5 m/s\n# limits.torque[0]: 8 N m\n# payload: 0.1 kg\n"));
  EXPECT_EQ(file.find("limits.torque[1]"), std::string::npos);  // the robot's own

  const Result own = run({"verify", "out/trajectory.csv"});
  EXPECT_EQ(own.exit_code, 0) << own.out;
  EXPECT_EQ(own.err, "");
  EXPECT_THAT(own.out, AllOf(HasSubstr("certified against the robot's limits and the request's"),
                             HasSubstr("payload 0.1 kg, limits.torque[0] 8 N m, limits.tip_speed 0.5 m/s\n")));

  const Result other = run({"verify", "out/trajectory.csv", "--payload", "0.3"});
  EXPECT_EQ(other.exit_code, 4);
  EXPECT_THAT(other.err, HasSubstr("payload: it was planned with 0.1 kg, but --payload says 0.3 kg\n"));
  EXPECT_THAT(other.out, HasSubstr("starts OUT OF BALANCE, motors "));  // still, and the springs as for 0.1 kg
  EXPECT_THAT(other.out, HasSubstr("failed      payload: it was planned with 0.1 kg"));  // before what follows from it
  EXPECT_EQ(other.err.find("another robot"), std::string::npos);

  const auto with = [&](const std::string& line, const std::string& instead) {
    std::string text = file;
    write("t.csv", text.replace(text.find(line), line.size(), instead));
    return run({"verify", "t.csv"});
  };
  const Result tighter = with("limits.torque[0]: 8 N m", "limits.torque[0]: 0.5 N m");
  EXPECT_EQ(tighter.exit_code, 4);
  EXPECT_THAT(tighter.out, HasSubstr("of 0.5 N m"));
  const Result looser = with("limits.torque[0]: 8 N m", "limits.torque[0]: 100 N m");
  EXPECT_THAT(looser.err, HasSubstr("limits.torque[0]: the file says 100 N m, but the robot's 12 N m hold\n"));
  EXPECT_THAT(looser.out, HasSubstr("limits.torque[0] 12 N m"));  // with what it was judged
  const Result wrong = with("payload: 0.1 kg", "payload: a cup");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(wrong.err, "fjr: t.csv: payload: 'a cup' must be a number >= 0 and its unit, such as '0.5 kg'\n");
  EXPECT_EQ(with("limits.torque[0]: 8 N m", "limits.torque[0]: -8 N m").exit_code, 2);
  EXPECT_EQ(with("limits.torque[0]", "limits.torqe[0]").exit_code, 2);
}

TEST_F(Cli, VerifyOfARobotWithAnotherPayloadSaysSo) {
  write("robot.yaml", contents(FJR_SOURCE_DIR "/config/robot.yaml") + "payload: 0.2\n");
  Trajectory trajectory = at_rest();
  trajectory.metadata["payload"] = "0.1 kg";
  write_csv(trajectory, path("t.csv"));
  const Result result = run({"verify", "t.csv", "--robot", "robot.yaml", "--json"});
  EXPECT_THAT(result.err, HasSubstr("t.csv: payload: it was planned with 0.1 kg, but the robot has 0.2 kg\n"));
  EXPECT_EQ(Json::parse(result.out)["payload"]["mass"], 0.2);
  EXPECT_EQ(Json::parse(result.out)["contradictions"].size(), 1u);
}

TEST_F(Cli, VerifyOfBadFilesIsBadInput) {
  write_csv(at_rest(), path("good.csv"));
  write("broken.csv", contents(path("good.csv")) + "1,2,3\n");
  write("robot.yaml", "link: {}\n");
  const Result broken = run({"verify", "broken.csv"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_EQ(broken.err, "fjr: broken.csv: line 23: 3 fields where the header has 11 columns\n");
  EXPECT_EQ(run({"verify", "none.csv"}).exit_code, 2);
  EXPECT_EQ(run({"verify", "."}).exit_code, 2);
  EXPECT_EQ(run({"verify", "good.csv", "--robot", "none.yaml"}).exit_code, 2);
  EXPECT_EQ(run({"verify", "good.csv", "--robot", "robot.yaml"}).exit_code, 2);
}

TEST_F(Cli, ReportOnTwoPlans) {
  write("a.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n");
  write("b.yaml", "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.22]}\nsample_period: 0.005\n");
  ASSERT_EQ(run({"plan", "a.yaml", "b.yaml", "--out", "out"}).exit_code, 0);
  EXPECT_EQ(run({"report", "out/a", "out/b"}).out, "out/a/compared.html\n");
  EXPECT_THAT(contents(path("out/a/compared.html")), HasSubstr("<title>Plans: a and b</title>"));
  EXPECT_EQ(run({"report", "out/a", "out/b", "--out", "both.html"}).out, "both.html\n");
  EXPECT_EQ(contents(path("both.html")), contents(path("out/a/compared.html")));
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"report", "out/a", "out/a"},
                                             {"report", "out/a", "out/none"},
                                             {"report", "out/a", "--out", "one.html"},
                                             {"report", "out/a", "out/b", "out/a"}}) {
    EXPECT_EQ(run(wrong).exit_code, 2) << testing::PrintToString(wrong);
  }
  EXPECT_FALSE(fs::exists(path("one.html")));
}

TEST_F(Cli, SimulateDoesNotReplaceItsInputs) {
  write_csv(at_rest(), path("t.csv"));
  const std::string motion = contents(path("t.csv")), robot = contents(FJR_SOURCE_DIR "/config/robot.yaml");
  write("arm.yaml", robot);
  fs::create_symlink("t.csv", path("link.csv"));
  const auto refusal = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"simulate", "t.csv", "--control", "executor", "--true-robot", "arm.yaml"});
    const Result result = run(more);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(refusal({"--out", "t.csv"}), HasSubstr("--out: t.csv would overwrite the input t.csv"));
  EXPECT_THAT(refusal({"--out", "link.csv"}), HasSubstr("--out: link.csv would overwrite the input t.csv"));
  EXPECT_THAT(refusal({"--log", "t.csv"}), HasSubstr("--log: t.csv would overwrite the input t.csv"));
  EXPECT_THAT(refusal({"--out", "./arm.yaml"}), HasSubstr("--out: ./arm.yaml would overwrite the input arm.yaml"));
  EXPECT_EQ(contents(path("t.csv")), motion);
  EXPECT_EQ(contents(path("arm.yaml")), robot);
}

TEST_F(Cli, SimulateRunsAnyTrajectory) {
  write_csv(at_rest(), path("t.csv"));
  const Result result = run({"simulate", "t.csv", "--hold", "0.1", "--out", "run.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("t.csv: closed-loop, 0.02 s\n"), HasSubstr("within one count 0.000 s after"),
                                HasSubstr("torque 1 ")));
  const Trajectory did = read_csv(path("run.csv"));
  EXPECT_NEAR(did.end_time(), 0.12, 1e-9);
  EXPECT_LE(did.samples.size(), 122U);

  // A foreign motion: rows that no arm of these follows, and which need not be exact to be run.
  Trajectory foreign;
  for (int k = 0; k <= 200; ++k) {
    const double c = k / 200.0;
    Sample row{.time = k * 1e-3, .state = {}, .torque = {}};
    row.state.q[0] = row.state.theta[0] = 0.05 * c * c * (3 - 2 * c);
    row.state.dq[0] = row.state.dtheta[0] = 0.05 * 6 * c * (1 - c) / 0.2;
    foreign.samples.push_back(row);
  }
  write_csv(foreign, path("foreign.csv"));
  const Json moving = Json::parse(run({"simulate", "foreign.csv", "--json"}).out);
  EXPECT_TRUE(moving["after_end"].is_null());  // it does not end where the springs hold the links
  EXPECT_GT(moving["link_error_rad"][0], 1e-4);
  foreign.samples.back().state = rest_at(load_parameters(FJR_SOURCE_DIR "/config/robot.yaml"), {0.05, 0});
  write_csv(foreign, path("foreign.csv"));
  const Json json = Json::parse(run({"simulate", "foreign.csv", "--json"}).out);
  EXPECT_EQ(json["completed"], true);
  EXPECT_EQ(json["after_end"]["window"], 1.0);
  EXPECT_GT(json["after_end"]["residual_rad"][0], 1e-4);
  EXPECT_GT(json["effort"], 0);
  ASSERT_EQ(json["limits"].size(), 8U);
  EXPECT_EQ(json["limits"][0]["name"], "torque");
  EXPECT_EQ(json["limits"][0]["limit"], 12.0);
  EXPECT_GT(json["limits"][0]["reached"], 0);
  EXPECT_TRUE(
      Json::parse(run({"simulate", "foreign.csv", "--control", "open-loop", "--json"}).out)["after_end"].is_null());
  const Json ticks = Json::parse(run({"simulate", "foreign.csv", "--control", "executor", "--json"}).out);
  EXPECT_EQ(ticks["control"], "executor");
  EXPECT_NE(ticks["effort"], json["effort"]);
}

TEST_F(Cli, SimulateKnowsTheFilesPayloadAndAnotherArm) {
  Trajectory trajectory = at_rest();
  for (Sample& row : trajectory.samples) row.state.q[0] = row.state.theta[0] = 0.3;
  write_csv(trajectory, path("t.csv"));
  const auto off = [&](std::vector<std::string> options) {
    std::vector<std::string> all{"simulate", "t.csv", "--json"};
    all.insert(all.end(), options.begin(), options.end());
    const Result result = run(all);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["link_error_rad"][0].get<double>();
  };
  const double own = off({});  // it falls, for nothing holds it
  write("heavier.yaml", contents(FJR_SOURCE_DIR "/config/robot.yaml") + "payload: 0.4\n");
  const double heavier = off({"--true-robot", "heavier.yaml"});
  EXPECT_NE(heavier, own);
  trajectory.metadata["payload"] = "0.4 kg";
  write_csv(trajectory, path("t.csv"));
  EXPECT_EQ(off({}), heavier);
}

TEST_F(Cli, SimulateOfBadInput) {
  write_csv(at_rest(), path("good.csv"));
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"simulate"},
                                             {"simulate", "none.csv"},
                                             {"simulate", "good.csv", "--hold", "11"},
                                             {"simulate", "good.csv", "--control", "loop"},
                                             {"simulate", "good.csv", "--robot", "none.yaml"},
                                             {"simulate", "good.csv", "--true-robot", "none.yaml"}}) {
    const Result result = run(wrong);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(wrong);
    EXPECT_NE(result.err, "");
    EXPECT_EQ(result.out, "");
  }
  EXPECT_THAT(run({"simulate", "good.csv", "--control", "open_loop"}).err, HasSubstr("did you mean open-loop?"));
}

TEST_F(Cli, ReportComesFromTheFolderAlone) {
  write("good.yaml", kReach);
  EXPECT_EQ(run({"plan", "good.yaml", "--out", "out", "--report"}).exit_code, 0);
  const std::string report = contents(path("out/report.html"));
  EXPECT_THAT(report, HasSubstr("id='plan-data'"));
  fs::remove(path("out/report.html"));
  const Result again = run({"report", "out"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, "out/report.html\n");
  EXPECT_EQ(contents(path("out/report.html")), report);
  EXPECT_EQ(run({"plan", "good.yaml", "--out", "out", "--deadline", "1e-6"}).exit_code, 5);
  EXPECT_FALSE(fs::exists(path("out/report.html")));  // it was of another plan
  EXPECT_EQ(run({"report", "out"}).exit_code, 0);     // of what there is: why nothing came of it
}

TEST_F(Cli, ReportOfWhatIsNoPlanIsBadInput) {
  write("out/plan.json", "{}");
  for (const char* folder : {"out", "nowhere", "."}) {
    const Result result = run({"report", folder});
    EXPECT_EQ(result.exit_code, 2) << folder;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(path(folder) / "report.html"));
  }
}

}  // namespace
}  // namespace fjr
