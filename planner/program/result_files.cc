#include "planner/program/result_files.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "model/input_error.h"
#include "model/strict_yaml.h"
#include "planner/report/plan_page.h"
#include "planner/trajectory/atomic_file.h"

namespace fjr {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTrajectoryId = "trajectory.id";
constexpr const char* kReport = "report.html";

}  // namespace

void prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
  for (const char* file :
       {"plan.json", "trajectory.csv", "trajectory.uncertified.csv", "solution.cbor", kReport, kTrajectoryId}) {
    fs::remove(folder / file, error);
    if (error) {
      throw InputError("--out", "", fmt::format("cannot remove {}: {}", (folder / file).string(), error.message()));
    }
  }
}

fs::path write_report(const fs::path& folder) {
  const fs::path file = folder / kReport;
  write_file(file, plan_page(read_plan(folder)));
  return file;
}

bool has_report(const fs::path& folder) { return fs::exists(folder / kReport); }

void write_trajectory_id(const RequestId& id, const fs::path& folder) {
  write_file(folder / kTrajectoryId, to_text(id) + "\n");
}

RequestId read_trajectory_id(const fs::path& folder) {
  const fs::path file = folder / kTrajectoryId;
  std::ifstream in(file);
  if (!in) {
    throw InputError(
        folder.string(), "",
        "has no trajectory.id: it holds no trajectory planned by the service (fjr request REQUEST --out DIR)");
  }
  std::string line;
  std::getline(in, line);
  if (const auto id = request_id_from(line)) return *id;
  throw InputError(file.string(), "", shown(line) + " is not 32 hexadecimal digits, a minus and a number");
}

void describe(Trajectory& trajectory, const std::string& request, const std::string& request_hash,
              const std::string& robot_hash, PlanStatus status) {
  trajectory.metadata["request"] = request;
  trajectory.metadata["request_hash"] = request_hash;
  trajectory.metadata["robot_hash"] = robot_hash;
  trajectory.metadata["rows"] = std::to_string(trajectory.samples.size());  // a file that was cut short shows it
  trajectory.metadata["status"] = name(status);
  trajectory.metadata["version"] = FJR_VERSION;
}

}  // namespace fjr
