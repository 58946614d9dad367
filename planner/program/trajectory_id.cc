#include "planner/program/trajectory_id.h"

#include <fstream>
#include <string>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/results/result_folder.h"

namespace fjr {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTrajectoryId = "trajectory.id";

}  // namespace

void write_trajectory_id(const RequestId& id, const fs::path& folder) {
  write_file(folder / kTrajectoryId, to_text(id) + "\n");
}

RequestId read_trajectory_id(const fs::path& folder) {
  const fs::path file = folder / kTrajectoryId;
  std::ifstream in(file);
  if (!in) {
    const fs::path previous = folder / kPrevious;
    const bool earlier = fs::exists(previous / kTrajectoryId);
    throw InputError(
        folder.string(), "",
        "has no trajectory.id: it holds no trajectory planned by the service (fjr request REQUEST --out DIR)" +
            (earlier ? "; that of the earlier plan is in " + previous.string() : ""));
  }
  std::string line;
  std::getline(in, line);
  if (const auto id = request_id_from(line)) return *id;
  throw InputError(file.string(), "", shown(line) + " is not 32 hexadecimal digits, a minus and a number");
}

}  // namespace fjr
