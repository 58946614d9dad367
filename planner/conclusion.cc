#include "planner/conclusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fjr {
namespace {

// How far the search came, for whoever wants to go on.
std::string how_far(const Findings& found, const Session& session) {
  if (!session.account().cut_by_work) return "";
  return fmt::format(
      "; the search ended where a request may take no more work (up to about {0:.0f} s of one core, counted in steps "
      "of the optimiser), after {1} starts and {2} minima: a --deadline of more than {0:.0f} s allows for more",
      session.options().most_work, found.starts, found.minima.size());
}

// What the other schemes need finer meshes for, or have no polynomial for, the usual one may find.
std::string other_method(const Findings& found) {
  if (found.asked.method == kDefaultMethod) return "";
  return fmt::format("; method: {}, the default, may lead to a plan", kDefaultMethod);
}

void withdraw_rows(Plan& plan) {
  plan.trajectory.reset();
  plan.certificate.reset();
}

// Whether the rows keep every limit, and the task, as they are planned: then it is exactness that they lack, and not
// a motion.
bool keeps_what_was_asked(const Certificate& certificate) {
  const auto kept = [](const LimitCheck& limit) { return limit.passed || limit.reached <= limit.limit; };
  const auto passed = [](const TaskCheck& constraint) { return constraint.passed; };
  return std::all_of(certificate.limits.begin(), certificate.limits.end(), kept) &&
         std::all_of(certificate.task.begin(), certificate.task.end(), passed);
}

// What may help a motion that is not exact enough.
std::string advice(const std::vector<Relaxation>& relaxations) {
  if (relaxations.empty()) return "";
  const Relaxation& r = relaxations.front();
  return fmt::format("; with {} of {:.4g} {} (now {:g}) it may be found", name_of(r.name, r.joint), r.to, r.unit,
                     r.from);
}

// Rows that may have been exact enough were more than there may be.
std::string too_many_rows(const Findings& found) { return found.failure.empty() ? "" : "; " + found.failure; }

constexpr const char* kOnCoarseMeshOnly = "the optimiser converged on a coarse mesh, but not on a finer one";

// Motions within the limits were found on coarse meshes, and no change was found to be needed: more likely the motions
// could not be refined than that there are none.
bool only_refining_failed(const Findings& found, const Infeasibility& infeasibility) {
  const bool any = !found.minima.empty() || !found.candidates.empty();
  return any && infeasibility.relaxations.empty() && !found.too_short();
}

// Nothing certified was found, and nobody stopped the search.
void tell_failure(const Findings& found, Plan& plan) {
  const bool nothing_converged = found.candidates.empty();
  const auto is_rough = [](const std::vector<Relaxation>& all) { return !all.empty() && all.front().rough; };
  if (plan.infeasibility && plan.certificate && keeps_what_was_asked(*plan.certificate)) {
    plan.reason += advice(plan.infeasibility->relaxations);  // what was asked is possible, and only not exact enough
    plan.infeasibility.reset();
  } else if (plan.infeasibility && plan.certificate && is_rough(plan.infeasibility->relaxations)) {
    plan.reason += "; " + plan.infeasibility->sentence;  // only smoothed motions tell what would have to change
  } else if (plan.infeasibility && only_refining_failed(found, *plan.infeasibility)) {
    plan.infeasibility.reset();
    if (plan.certificate) return;  // uncertified, with its first failure
    plan.status = PlanStatus::kNotConverged;
    plan.reason = found.failure.empty() ? kOnCoarseMeshOnly : found.failure;
  } else if (plan.infeasibility) {
    plan.status = PlanStatus::kInfeasible;
    plan.reason = plan.infeasibility->sentence;
    withdraw_rows(plan);  // what converged on a coarse mesh only
  } else if (plan.certificate) {
    return;  // uncertified, with its first failure
  } else if (found.a_start_was_infeasible && nothing_converged && !found.fastest) {
    plan.status = PlanStatus::kInfeasible;
    plan.reason = "no motion within the limits was found from any start" + found.obstacle;
  } else {
    plan.status = PlanStatus::kNotConverged;
    plan.reason = !found.failure.empty() ? found.failure
                  : nothing_converged    ? "the optimiser converged from no start" + found.obstacle
                                         : kOnCoarseMeshOnly;
  }
}

}  // namespace

void conclude(const Findings& found, Session& session, Plan& plan) {
  const bool certified = plan.status == PlanStatus::kCertified;
  if (certified && session.deadline_passed()) {  // what was certified in time is the plan
    plan.cut_by_deadline = true;
  } else if (session.stopped() && !(session.deadline_passed() && plan.infeasibility)) {
    plan.infeasibility.reset();
    plan.status = session.deadline_passed() ? PlanStatus::kDeadline : PlanStatus::kCancelled;
    plan.reason = session.deadline_passed()
                      ? fmt::format("the time budget of {} s was used up", session.options().deadline)
                      : "stopped on request";
    withdraw_rows(plan);
  } else if (!certified || plan.infeasibility) {
    tell_failure(found, plan);
    if (plan.certificate) plan.reason += too_many_rows(found);
    const bool explained = plan.status == PlanStatus::kInfeasible && !session.interrupted() && !found.swing_was_cut;
    if (!explained) plan.reason += how_far(found, session);
    if (plan.status != PlanStatus::kInfeasible) plan.reason += other_method(found);
  }
}

}  // namespace fjr
