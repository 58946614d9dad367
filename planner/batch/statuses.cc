#include "planner/batch/statuses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "planner/plan.h"

namespace fjr {
namespace {

struct Status {
  const char* name;
  int exit_code;
};

Status of_plan(PlanStatus status) { return {name(status), exit_code(status)}; }

// The statuses in the order in which they are reported.
const std::array kStatuses = {of_plan(PlanStatus::kCertified),
                              of_plan(PlanStatus::kInfeasible),
                              of_plan(PlanStatus::kNotConverged),
                              of_plan(PlanStatus::kUncertified),
                              of_plan(PlanStatus::kBadInput),
                              of_plan(PlanStatus::kDeadline),
                              of_plan(PlanStatus::kCancelled),
                              Status{kFailedStatus, 1},
                              Status{kOpenStatus, exit_code(PlanStatus::kDeadline)}};

}  // namespace

std::size_t StatusCounts::of(const std::string& status) const {
  const auto found = counts_.find(status);
  return found == counts_.end() ? 0 : found->second;
}

nlohmann::ordered_json StatusCounts::to_json() const {
  nlohmann::ordered_json counts = nlohmann::ordered_json::object();
  for (const Status& status : kStatuses) {
    if (of(status.name) > 0) counts[status.name] = of(status.name);
  }
  return counts;
}

std::string StatusCounts::for_people() const {
  std::string text;
  for (const Status& status : kStatuses) {
    if (of(status.name) > 0) text += fmt::format("  {:<14} {}\n", status.name, of(status.name));
  }
  return text;
}

int StatusCounts::exit_code() const {
  int code = 0;
  for (const Status& status : kStatuses) {
    if (of(status.name) > 0) code = std::max(code, status.exit_code);
  }
  return code;
}

}  // namespace fjr
