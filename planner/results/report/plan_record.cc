#include "planner/results/report/plan_record.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "common/input_error.h"
#include "planner/certificate/consistency.h"
#include "planner/plan.h"
#include "planner/results/json_field.h"
#include "planner/results/strict_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
Parameters read_robot(const JsonField& plan) {
  const JsonField robot = plan.at("robot");
  Parameters p{};
  visit_parameters(p, [&](const char* section, const char* name, const char*, Joints<double>& values) {
    const auto given = robot.at(section).find(name);
    if (given || !may_be_left_out(section, name)) values = robot.at(section).at(name).pair();
  });
  if (const auto mounting = robot.find("mounting")) {
    p.mounting.gravity = mounting->at("gravity").number();
    p.mounting.down = mounting->at("down").number();
  }
  if (const auto payload = robot.find("payload")) {
    p.payload = {payload->at("mass").number(), payload->at("inertia").number()};
  }
  if (robot_hash(p) != plan.at("robot_hash").text()) {
    robot.fail("is not the robot that robot_hash tells of; the file was changed after it was planned");
  }
  return p;
}

void check_belonging(const Trajectory& trajectory, const fs::path& file, const JsonField& plan) {
  const auto said = [&](const char* key) {
    const auto found = trajectory.metadata.find(key);
    return found == trajectory.metadata.end() ? "" : found->second;
  };
  for (const char* key : {"request_hash", "robot_hash"}) {
    if (said(key) == plan.at(key).text()) continue;
    throw InputError(file.string(), key, "is not that of the plan.json beside it: they are of different plans");
  }
  if (const std::string rows = said("rows"); rows != std::to_string(trajectory.samples.size())) {
    throw InputError(file.string(), "rows",
                     fmt::format("the file has {} rows, but says that it had '{}'", trajectory.samples.size(), rows));
  }
}

}  // namespace

PlanRecord record_of(nlohmann::ordered_json plan, std::string source, std::optional<Trajectory> trajectory) {
  PlanRecord record{std::move(source), std::move(plan), {}, std::move(trajectory)};
  record.robot = read_robot(JsonField(record.plan, record.source));
  return record;
}

PlanRecord read_plan(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(folder.string(), "", "is no folder");
  const fs::path file = folder / "plan.json";
  PlanRecord record{file.string(), load_plan_json(folder), {}, {}};
  const JsonField plan(record.plan, record.source);
  const std::optional<PlanStatus> status = plan_status(plan.at("status").text());
  if (status == PlanStatus::kBadInput) {
    throw InputError(record.source, "", "the request was refused and nothing planned: " + plan.at("reason").text());
  }
  record.robot = read_robot(plan);
  const bool certified = status == PlanStatus::kCertified;
  const fs::path rows = folder / (certified ? "trajectory.csv" : "trajectory.uncertified.csv");
  if (certified || (status == PlanStatus::kUncertified && fs::exists(rows, error))) {
    record.trajectory = read_csv(rows);
    if (const auto fault = malformed(*record.trajectory)) throw InputError(rows.string(), "", *fault);
    check_belonging(*record.trajectory, rows, plan);
  }
  return record;
}

}  // namespace fjr
