#include "planner/program/altered.h"

#include <fmt/format.h>

#include <string>

#include "common/input_error.h"
#include "common/say.h"
#include "planner/plan.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

bool says_certified(const PlanRecord& plan) {
  const auto status = plan.plan.find("status");
  return status != plan.plan.end() && *status == name(PlanStatus::kCertified);
}

// Returns what is wrong with the certificate that the plan says it has; empty if nothing is.
std::string fault_of_rows(const PlanRecord& plan) {
  try {
    VerifyOptions options;
    options.planned = planned_motion_in(plan.plan, plan.source);
    options.planned.proven = false;
    options.planned.robust.reset();
    const Verification v = verify(*plan.trajectory, plan.source, plan.robot, options);
    return v.certificate.certified ? "" : "the rows are not: " + v.certificate.failures.front();
  } catch (const InputError& error) {
    return fmt::format("that cannot be checked: {}", error.what());
  }
}

}  // namespace

void warn_if_altered(const std::filesystem::path& folder, const PlanRecord& plan) {
  if (!plan.trajectory || !says_certified(plan)) return;
  const std::string fault = fault_of_rows(plan);
  if (fault.empty()) return;
  say("fjr: warning: {}: plan.json says that it is certified, and {}\n", folder.string(), fault);
}

}  // namespace fjr
