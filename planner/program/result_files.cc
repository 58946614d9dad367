#include "planner/program/result_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/input_error.h"
#include "planner/results/result_folder.h"

namespace fjr {

namespace fs = std::filesystem;

namespace {

constexpr const char* kReport = "report.html";

}  // namespace

void prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
  check_names_in(folder);
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return;
  const std::string reason = std::generic_category().message(errno);
  throw InputError("--out", "", fmt::format("cannot write to folder {}: {}", folder.string(), reason));
}

std::string about_previous(const fs::path& folder, PlanStatus status, bool kept) {
  const fs::path previous = folder / kPrevious;
  if (status != PlanStatus::kCertified && has_certified_plan(previous)) {
    return fmt::format("the earlier certified plan is in {}", previous.string());
  }
  return kept ? fmt::format("the earlier results are in {}", previous.string()) : "";
}

bool has_report(const fs::path& folder) { return fs::exists(folder / kReport); }

}  // namespace fjr
