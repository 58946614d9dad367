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

// Visits each status that occurs with its exit code: those listed above in their order, then others, which an older or
// newer version may have written, with the exit code of what failed.
template <class Visit>
void StatusCounts::each(const Visit& visit) const {
  for (const Status& status : kStatuses) {
    if (of(status.name) > 0) visit(status.name, status.exit_code);
  }
  for (const auto& [status, count] : counts_) {
    const auto is_it = [&, &name = status](const Status& listed) { return name == listed.name; };
    if (std::none_of(kStatuses.begin(), kStatuses.end(), is_it)) visit(status, 1);
  }
}

nlohmann::ordered_json StatusCounts::to_json() const {
  nlohmann::ordered_json counts = nlohmann::ordered_json::object();
  each([&](const std::string& status, int) { counts[status] = of(status); });
  return counts;
}

std::string StatusCounts::for_people() const {
  std::string text;
  each([&](const std::string& status, int) { text += fmt::format("  {:<14} {}\n", status, of(status)); });
  return text;
}

int StatusCounts::exit_code() const {
  int code = 0;
  each([&](const std::string&, int of_status) { code = std::max(code, of_status); });
  return code;
}

}  // namespace fjr
