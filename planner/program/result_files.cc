#include "planner/program/result_files.h"

#include <fmt/format.h>

#include <system_error>

#include "model/input_error.h"

namespace fjr {

namespace fs = std::filesystem;

void prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
  for (const char* file : {"plan.json", "trajectory.csv", "trajectory.uncertified.csv", "solution.cbor"}) {
    fs::remove(folder / file, error);
    if (error) {
      throw InputError("--out", "", fmt::format("cannot remove {}: {}", (folder / file).string(), error.message()));
    }
  }
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
