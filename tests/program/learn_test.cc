// The built program on motions that are repeated: simulate writes the logs that learn takes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "model/dynamics.h"
#include "planner/results/result_folder.h"
#include "planner/trajectory/trajectory.h"
#include "tests/support/cli.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kCount = 2 * 3.14159265358979 / 65536;  // [rad] of the links' encoders

// Of both links together, rms: a count each, and 1.6 times that. Measured: 115, 2.2, 1.4, 1.6.
constexpr double kNoise = 2.3;

// A motion with torque to spare, and an arm with softer springs and more friction than it was planned for.
class LearnCommand : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    use_plan();
    write("wrong.yaml",
          replaced(replaced(contents(FJR_SOURCE_DIR "/config/robot.yaml"), "20.48, 17.75", "19.46, 16.86"),
                   "0.4968, 0.5051", "0.5962, 0.6061"));
  }

  void plan(const std::string& more) const {
    write("move.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 0.8\n" + more);
    const Result planned = run({"plan", "move.yaml", "--out", "out"});
    ASSERT_EQ(planned.exit_code, 0) << planned.out << planned.err;
  }

  // The folder out; the same for all tests, which is planned once.
  void use_plan() const {
    static std::map<std::string, std::string> files;
    if (!files.empty()) {
      fs::create_directory(path("out"));
      for (const auto& [name, text] : files) write(name, text);
      return;
    }
    plan("limits: {torque: [10, 4]}\n");
    files["move.yaml"] = contents(path("move.yaml"));
    for (const char* name : {"out/plan.json", "out/trajectory.csv", "out/solution.cbor"}) {
      files[name] = contents(path(name));
    }
  }

  void execute(const std::string& folder, const std::string& log, const std::string& arm = "wrong.yaml") const {
    const Result simulated =
        run({"simulate", folder + "/trajectory.csv", "--control", "executor", "--true-robot", arm, "--log", log});
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  }

  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }

  // Bad input of one line that says all of these, and no folder of results.
  template <class... Words>
  void refuses(const std::string& log, const Words&... words) const {
    const Result result = run({"learn", "out", log, "--out", "next"});
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_THAT(result.err, AllOf(HasSubstr(log), HasSubstr(words)...));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(path("next/plan.json")));
  }
};

TEST_F(LearnCommand, RepetitionsFollowThePlanEverMoreExactly) {
  std::string folder = "out";
  double before = 1e9;
  for (int run_number = 1; run_number <= 4; ++run_number) {
    const std::string log = "run" + std::to_string(run_number) + ".csv", next = "next" + std::to_string(run_number);
    execute(folder, log);
    const Result learnt = run({"learn", folder, log, "--out", next});
    ASSERT_EQ(learnt.exit_code, 0) << learnt.out << learnt.err;
    const nlohmann::json plan = plan_json(next), repetition = plan["repetition"];
    EXPECT_EQ(repetition["number"], run_number + 1);
    const double rms = std::hypot(repetition["last_link_error_rms_rad"][0].get<double>(),
                                  repetition["last_link_error_rms_rad"][1].get<double>()) /
                       kCount;
    EXPECT_LT(rms, std::max(kNoise, before / 2)) << learnt.out;
    before = rms;
    for (const auto& rehearsal : repetition["rehearsals"]) {
      EXPECT_TRUE(rehearsal["broken"].empty());
      for (const auto& limit : rehearsal["limits"]) EXPECT_TRUE(limit["passed"]) << limit;
    }
    EXPECT_THAT(learnt.out, AllOf(HasSubstr("limits       kept; nearest"), Not(HasSubstr("NOT KEPT"))));
    const auto& runs = repetition["runs"];
    ASSERT_EQ(runs.size(), static_cast<std::size_t>(run_number));
    EXPECT_EQ(runs.back()["number"], run_number);
    EXPECT_EQ(runs.back()["link_error_rms_rad"], repetition["last_link_error_rms_rad"]);
    EXPECT_EQ(run({"report", next}).exit_code, 0);
    folder = next;
  }
  const std::string report = contents(path(folder + "/report.html"));
  EXPECT_THAT(report, AllOf(HasSubstr("These rows are for run 5"), HasSubstr("Links off the plan, by run"),
                            HasSubstr("the model with the learnt torques")));
  EXPECT_LT(before, kNoise);
}

// What plan.json says of earlier runs is read as strictly as all else, and nothing is written where it is damaged.
TEST_F(LearnCommand, ADamagedRepetitionIsNamed) {
  execute("out", "run.csv");
  const auto fault_of = [&](const std::string& repetition) {
    nlohmann::json plan = plan_json("out");
    plan["repetition"] = nlohmann::json::parse(repetition);
    write("out/plan.json", plan.dump());
    const Result result = run({"learn", "out", "run.csv", "--out", "next"});
    EXPECT_EQ(result.exit_code, 2) << repetition;
    EXPECT_FALSE(fs::exists(path("next/plan.json")));
    return result.err;
  };
  EXPECT_THAT(fault_of("{}"), HasSubstr("out/plan.json: repetition.number: missing"));
  EXPECT_THAT(fault_of("[2]"), HasSubstr("out/plan.json: repetition: must be an object"));
  for (const char* number : {"\"two\"", "null", "0", "1.5", "2147483647", "1e300"}) {
    EXPECT_THAT(fault_of(fmt::format(R"({{"number": {}}})", number)),
                HasSubstr("out/plan.json: repetition.number: must be "));
  }
  EXPECT_THAT(fault_of(R"({"number": 2, "runs": 3})"), HasSubstr("repetition.runs: must be a list"));
  EXPECT_THAT(fault_of(R"({"number": 2, "runs": [{}]})"), HasSubstr("repetition.runs[0].number: missing"));
  for (const char* began : {"[1]", "[null, 0]", "7"}) {
    EXPECT_THAT(fault_of(fmt::format(R"({{"number": 3, "runs": [
                  {{"number": 1, "link_error_rms_rad": [0, 0], "motors_began_rad": {}}},
                  {{"number": 2, "link_error_rms_rad": [0, 0], "motors_began_rad": [0, 0]}}]}})",
                                     began)),
                HasSubstr("repetition.runs[0].motors_began_rad: must be a list"));
  }
}

// The model's own arm is within a count, and noise is not learnt.
TEST_F(LearnCommand, WhatIsExactStaysAsItIs) {
  execute("out", "run.csv", FJR_SOURCE_DIR "/config/robot.yaml");
  const Result learnt = run({"learn", "out", "run.csv", "--out", "next"});
  ASSERT_EQ(learnt.exit_code, 0) << learnt.out;
  EXPECT_THAT(learnt.out, HasSubstr("nothing is left to learn but noise"));
  const Trajectory before = read_csv(path("out/trajectory.csv")), after = read_csv(path("next/trajectory.csv"));
  ASSERT_EQ(before.samples.size(), after.samples.size());
  for (std::size_t i = 0; i < before.samples.size(); ++i) {
    EXPECT_EQ(before.samples[i].torque, after.samples[i].torque);
  }
}

TEST_F(LearnCommand, ReplacesTheFolderUnlessAnotherIsGiven) {
  execute("out", "run.csv");
  const Trajectory planned = read_csv(path("out/trajectory.csv"));
  ASSERT_EQ(run({"learn", "out", "run.csv"}).exit_code, 0);
  const Trajectory learnt = read_csv(path("out/trajectory.csv"));
  EXPECT_EQ(learnt.metadata.at("status"), "learnt");
  EXPECT_EQ(learnt.metadata.at("repetition"), "2");
  EXPECT_EQ(learnt.metadata.at("request_hash"), planned.metadata.at("request_hash"));
  EXPECT_TRUE(fs::exists(path("out/solution.cbor")));
  EXPECT_EQ(run({"verify", "out"}).exit_code, 4);  // the model's arm does not do that
}

// All the torque there is has been planned with: what the softer arm needs besides is not to be had.
TEST_F(LearnCommand, WhatTheLimitsLeaveNoRoomForIsScaledDownOrRefused) {
  write("move.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: free\nobjective: fastest\n");
  ASSERT_EQ(run({"plan", "move.yaml", "--out", "out"}).exit_code, 0);
  execute("out", "run.csv");
  const Result result = run({"learn", "out", "run.csv", "--out", "next"});
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_THAT(result.out, AllOf(HasSubstr("REFUSED"), HasSubstr("torque of joint"), HasSubstr("its limit is 12")));
  EXPECT_FALSE(fs::exists(path("next/plan.json")));
  const nlohmann::json json = nlohmann::json::parse(run({"learn", "out", "run.csv", "--out", "next", "--json"}).out);
  EXPECT_EQ(json["fraction"], 0);
  EXPECT_FALSE(json["reasons"].empty());
}

TEST_F(LearnCommand, ALogOfAnotherMotionRobotOrEndIsBadInput) {
  execute("out", "run.csv");
  const std::string log = contents(path("run.csv"));
  write("stopped.csv", replaced(log, "# code: 0", "# code: -4"));
  refuses("stopped.csv", "# code", "-4", "not executed to its end");
  std::string hash = log.substr(log.find("# robot_hash: ") + 14, 8);
  write("robot.csv", replaced(log, hash, "00000000"));
  refuses("robot.csv", "# robot_hash", "another robot");
  write("words.csv", "time,q1\n0,far\n");
  refuses("words.csv", "q1");
  refuses("missing.csv");
  plan("limits: {torque: [9, 4]}\n");
  refuses("run.csv", "_plan, row", "not the log of that motion");
}

// A log's first row is at the start, and its last one a tick before the end: either half of the rows is not enough, nor
// are all but one at the end, or all but two at the start.
TEST_F(LearnCommand, ALogThatDoesNotCoverTheMotionIsBadInput) {
  execute("out", "run.csv");
  const std::string log = contents(path("run.csv"));
  const std::size_t rows = log.find('\n', log.find("\ntime,") + 1) + 1;
  const auto after_lines = [&](int lines) {
    std::size_t at = rows;
    for (int i = 0; i < lines; ++i) at = log.find('\n', at) + 1;
    return at;
  };
  const int count = static_cast<int>(std::count(log.begin() + static_cast<std::ptrdiff_t>(rows), log.end(), '\n'));
  for (const int kept : {count / 2, count - 1}) {
    write("begin.csv", log.substr(0, after_lines(kept)));
    refuses("begin.csv", "time, row " + std::to_string(kept), "the motion ends at 0.8 s");
  }
  for (const int cut : {count / 2, 2}) {
    write("end.csv", log.substr(0, rows) + log.substr(after_lines(cut)));
    refuses("end.csv", "time, row 1", "the motion begins at 0 s");
  }
  write("barely.csv", log.substr(0, rows) + log.substr(after_lines(1)));
  EXPECT_EQ(run({"learn", "out", "barely.csv", "--out", "next"}).exit_code, 0);
}

// A start at 1e100 rad/s cannot be integrated, which is seen at once (at 1e8 rad/s it takes 18 s of ever smaller
// steps).
TEST_F(LearnCommand, ASimulationThatBreaksDownSaysSoInItsLog) {
  execute("out", "run.csv");
  Trajectory rows = read_csv(path("out/trajectory.csv"));
  rows.samples.front().state.dq = {1e100, -1e100};
  write_csv(rows, path("out/trajectory.csv"));
  const Result simulated = run({"simulate", "out/trajectory.csv", "--control", "executor", "--log", "broken.csv"});
  EXPECT_EQ(simulated.exit_code, 1) << simulated.out;
  const std::string broken = contents(path("broken.csv"));
  EXPECT_THAT(broken, AllOf(HasSubstr("# code: -4"), HasSubstr("# sentence: the integration")));
  // As if it had broken down later.
  const std::string run_of_it = contents(path("run.csv"));
  write("later.csv", broken.substr(0, broken.find("time,")) + run_of_it.substr(run_of_it.find("time,")));
  refuses("later.csv", "# code", "the integration broke down");
}

// Another fjr that replaces a folder's results holds the lock of its parent folder; before it is done they may be in
// part the old ones and in part the new ones.
TEST_F(LearnCommand, WaitsForWhoReplacesTheFolder) {
  execute("out", "run.csv");
  auto lock = std::make_unique<FolderLock>(path("out"));
  auto learnt = std::async(std::launch::async, [&] { return run({"learn", "out", "nowhere.csv"}); });
  EXPECT_EQ(learnt.wait_for(std::chrono::seconds(3)), std::future_status::timeout);  // the message takes no tenth of it
  lock.reset();
  EXPECT_EQ(learnt.get().exit_code, 2);
}

// Gravity bends the springs of the true arm by 5 % more: with its motors where they are learnt to be, it hangs lower.
TEST_F(LearnCommand, ALearntMotionIsSimulatedFromWhereTheMotorsStand) {
  write("move.yaml", "start: {q: [1, 0]}\ngoal: {q: [0.2, 0.5]}\nduration: 0.8\n");
  ASSERT_EQ(run({"plan", "move.yaml", "--out", "out"}).exit_code, 0);
  execute("out", "run1.csv");
  ASSERT_EQ(run({"learn", "out", "run1.csv", "--out", "next"}).exit_code, 0);
  const Trajectory rows = read_csv(path("next/trajectory.csv"));
  for (const char* control : {"executor", "closed-loop"}) {
    const Result result = run({"simulate", "next/trajectory.csv", "--control", control, "--true-robot", "wrong.yaml",
                               "--out", "run.csv", "--hold", "0.5", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    const Trajectory run_of_it = read_csv(path("run.csv"));
    const Parameters wrong = load_parameters(path("wrong.yaml"));
    const State<double> start = run_of_it.samples.front().state, rest = rest_at(wrong, start.q);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_EQ(start.theta[j], rows.samples.front().state.theta[j]);
      EXPECT_NEAR(start.theta[j], rest.theta[j], 1e-8);
    }
    EXPECT_EQ(start.dq, (Joints<double>{}));
    ASSERT_FALSE(json["after_end"].is_null()) << control;
    EXPECT_EQ(json["after_end"]["window"], 0.5);
  }
}

// Numbers of the last line of a CSV, by column.
std::map<std::string, double> last_row(const std::string& csv) {
  std::istringstream lines(csv);
  std::string names, line, last, name, number;
  std::getline(lines, names);
  while (std::getline(lines, line)) last = line;
  std::istringstream of_names(names), of_numbers(last);
  std::map<std::string, double> row;
  while (std::getline(of_names, name, ',') && std::getline(of_numbers, number, ',')) row[name] = std::stod(number);
  return row;
}

// A motion that does not end with a tick.
TEST_F(LearnCommand, ALastTickMayBeShort) {
  write("move.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 0.8003\nlimits: {torque: [10, 4]}\n");
  ASSERT_EQ(run({"plan", "move.yaml", "--out", "out"}).exit_code, 0);
  execute("out", "run1.csv");
  ASSERT_EQ(run({"learn", "out", "run1.csv", "--out", "next"}).exit_code, 0);
  // A drive holds the goal with the last means that are exported: with the torque in the springs, as the executor does.
  ASSERT_EQ(run({"export", "next", "--format", "csv"}).exit_code, 0);
  const std::map<std::string, double> last = last_row(contents(path("next/export.csv")));
  const Sample goal = read_csv(path("next/trajectory.csv")).samples.back();
  EXPECT_NEAR(last.at("time_s"), 0.801, 1e-12);
  const Parameters robot = load_parameters(default_robot_file());
  const Joints<double> held = spring_torque(robot, goal.state.q, goal.state.theta);
  EXPECT_NEAR(last.at("tau1_mean_N_m"), held[0], 1e-9);
  EXPECT_NEAR(last.at("tau2_mean_N_m"), held[1], 1e-9);
  execute("next", "run2.csv");
  const Result learnt = run({"learn", "next", "run2.csv", "--json"});
  const nlohmann::json rms = nlohmann::json::parse(learnt.out)["last_link_error_rms_rad"];
  EXPECT_LT(std::hypot(rms[0].get<double>(), rms[1].get<double>()) / kCount, 2 * kNoise) << learnt.out;
}

// The limits of the request are in the rows' header, and in plan.json, which nobody has edited.
TEST_F(LearnCommand, RowsWithoutTheirLimitsAreBadInput) {
  execute("out", "run.csv");
  std::string rows = contents(path("out/trajectory.csv"));
  for (const char* line : {"# limits.torque[0]: 10 N m\n", "# limits.torque[1]: 4 N m\n"})
    rows = replaced(rows, line, "");
  write("out/trajectory.csv", rows);
  const Result edited = run({"learn", "out", "run.csv", "--out", "next"});
  EXPECT_EQ(edited.exit_code, 2);
  EXPECT_THAT(edited.err, AllOf(HasSubstr("out/trajectory.csv: # limits.torque: does not say that torque of joint 1"),
                                HasSubstr("limited to 10 N m, as its request does")));
}

TEST_F(LearnCommand, WhatIsNoPlanIsBadInput) {
  execute("out", "run.csv");
  const Result nowhere = run({"learn", "nowhere", "run.csv"});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("nowhere: is no folder"));
  fs::remove(path("out/trajectory.csv"));
  EXPECT_EQ(run({"learn", "out", "run.csv"}).exit_code, 2);
}

TEST_F(LearnCommand, OnlyTheExecutorsControlHasALog) {
  const Result result = run({"simulate", "out/trajectory.csv", "--log", "run.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--log"), HasSubstr("closed-loop"), HasSubstr("--control executor")));
  EXPECT_FALSE(fs::exists(path("run.csv")));
}

}  // namespace
}  // namespace fjr
