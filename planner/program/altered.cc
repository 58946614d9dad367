#include "planner/program/altered.h"

#include <string>

#include "common/input_error.h"
#include "common/say.h"
#include "planner/plan.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

// Returns why the rows do not have the certificate that the plan says they have; empty if they do.
std::string fault_of_rows(const std::filesystem::path& folder, const PlanRecord& plan) {
  try {
    VerifyOptions options;
    options.planned = planned_motion(folder);
    if (options.planned.status != name(PlanStatus::kCertified)) return "";
    options.planned.proven = false;
    options.planned.robust.reset();
    const Verification v = verify(*plan.trajectory, plan.source, plan.robot, options);
    return v.certificate.certified ? "" : v.certificate.failures.front();
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

void warn_if_altered(const std::filesystem::path& folder, const PlanRecord& plan) {
  if (!plan.trajectory) return;
  const std::string fault = fault_of_rows(folder, plan);
  if (fault.empty()) return;
  say("fjr: warning: {}: the plan says that it is certified, and its rows are not: {}\n", folder.string(), fault);
}

}  // namespace fjr
