// Folders of plans that are read again, and folders that are none.
#include "planner/results/report/plan_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/input_error.h"
#include "planner/results/report/plan_page.h"
#include "tests/planner/reported_plan.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::HasSubstr;

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write("plan.json", json_text(reach().plan));
    Trajectory trajectory = *reach().trajectory;
    trajectory.metadata["rows"] = std::to_string(trajectory.samples.size());
    write_csv(trajectory, folder_ / "trajectory.csv");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void write_changed(const char* pointer, const Json& value) const {
    Json plan = reach().plan;
    plan[Json::json_pointer(pointer)] = value;
    write("plan.json", json_text(plan));
  }
  std::string complaint() const {
    try {
      read_plan(folder_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  fs::path folder_ = fs::temp_directory_path() / ("fjr_report_test_" + std::to_string(::getpid()));
};

TEST_F(Folder, IsReadAsItWasWritten) {
  const PlanRecord record = read_plan(folder_);
  EXPECT_EQ(robot_hash(record.robot), robot_hash(reach().robot));
  EXPECT_EQ(record.trajectory->samples.size(), reach().trajectory->samples.size());
  EXPECT_EQ(plan_page(record), plan_page(reach()));
}

// The robot that a request was planned for has the request's payload.
TEST_F(Folder, RemembersThePayload) {
  const Problem problem =
      parse_request("start: {q: [0, 0]}\ngoal: {q: [0.5, 0]}\npayload: {mass: 0.3, inertia: 0.001}\n", "reach.yaml",
                    load_parameters(kRobot));
  write("plan.json", json_text(plan_json(problem, {})));
  EXPECT_EQ(read_plan(folder_).robot.payload, problem.robot.payload);
  write_changed("/robot/payload/mass", 0.3);
  EXPECT_THAT(complaint(), HasSubstr("robot: is not the robot that robot_hash tells of"));
}

TEST_F(Folder, ThatIsNoPlanIsRefusedWithTheReason) {
  write_changed("/robot/spring/stiffness/1", 18);
  EXPECT_THAT(complaint(), HasSubstr("plan.json: robot: is not the robot that robot_hash tells of"));
  write_changed("/robot/spring/stiffness", nullptr);
  EXPECT_THAT(complaint(), HasSubstr("plan.json: robot.spring.stiffness: must be a list"));
  write_changed("/request_hash", "another");
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv: request_hash: is not that of the plan.json beside it"));
  write("plan.json", "{\"status\": \"certified\"");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: is damaged"));
  write("plan.json", "[1, 2]");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: must be an object"));
  write("plan.json", json_text(bad_input_json("reach", "goal.q[1]: 9 rad is outside", "goal.q[1]")));
  EXPECT_THAT(complaint(), HasSubstr("nothing planned: goal.q[1]: 9 rad is outside"));
  fs::remove(folder_ / "plan.json");
  EXPECT_THAT(complaint(), HasSubstr("plan.json: cannot be read: this is no folder of a plan"));
  fs::remove_all(folder_);
  EXPECT_THAT(complaint(), HasSubstr("is no folder"));
}

TEST_F(Folder, WithADamagedTrajectoryIsRefused) {
  const fs::path rows = folder_ / "trajectory.csv";
  fs::resize_file(rows, fs::file_size(rows) / 2);
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv"));
  Trajectory cut = *reach().trajectory;
  cut.metadata["rows"] = std::to_string(cut.samples.size());
  cut.samples.pop_back();
  write_csv(cut, rows);
  EXPECT_THAT(complaint(), HasSubstr("but says that it had"));
  fs::remove(rows);
  EXPECT_THAT(complaint(), HasSubstr("trajectory.csv: no such file"));
}

}  // namespace
}  // namespace fjr
