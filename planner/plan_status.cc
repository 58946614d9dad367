// Names and exit codes of outcomes, which plan.json, the command line and the service share.
#include <algorithm>
#include <array>
#include <stdexcept>

#include "planner/plan.h"

namespace fjr {
namespace {

struct NamedStatus {
  PlanStatus status;
  const char* name;
  int exit_code;
};

constexpr std::array<NamedStatus, 7> kNamedStatuses{{{PlanStatus::kCertified, "certified", 0},
                                                     {PlanStatus::kBadInput, "bad_input", 2},
                                                     {PlanStatus::kInfeasible, "infeasible", 3},
                                                     {PlanStatus::kNotConverged, "not_converged", 3},
                                                     {PlanStatus::kUncertified, "uncertified", 4},
                                                     {PlanStatus::kDeadline, "deadline", 5},
                                                     {PlanStatus::kCancelled, "cancelled", 5}}};

const NamedStatus& entry_of(PlanStatus status) {
  const auto found = std::find_if(kNamedStatuses.begin(), kNamedStatuses.end(),
                                  [&](const NamedStatus& o) { return o.status == status; });
  if (found == kNamedStatuses.end()) throw std::logic_error("PlanStatus out of range");
  return *found;
}

}  // namespace

const char* name(PlanStatus status) { return entry_of(status).name; }

std::optional<PlanStatus> plan_status(std::string_view name) {
  const auto found =
      std::find_if(kNamedStatuses.begin(), kNamedStatuses.end(), [&](const NamedStatus& o) { return o.name == name; });
  return found == kNamedStatuses.end() ? std::nullopt : std::optional(found->status);
}

int exit_code(PlanStatus status) { return entry_of(status).exit_code; }

}  // namespace fjr
