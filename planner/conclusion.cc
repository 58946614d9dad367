#include "planner/conclusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "planner/problem/relaxable.h"

namespace fjr {
namespace {

// Returns how far the search came, for users who want to continue it.
std::string how_far(const Findings& found, const Session& session) {
  if (!session.account().cut_by_work) return "";
  return fmt::format(
      "; the search reached its limit of work (about {0:.0f} s of one core, counted in steps of the optimiser) after "
      "{1} starts and {2} minima; a --deadline of more than {0:.0f} s raises it",
      session.most_work(), found.starts, found.minima.size());
}

// Returns what a robust motion had come to when its time was over.
std::string by_then(const Findings& found) {
  return found.certified_for_the_robot ? "; a motion without margins for other arms was certified by then" : "";
}

// Suggests the default scheme: it may find motions for which others need finer meshes or have no suitable polynomial.
std::string other_method(const Findings& found) {
  if (found.asked.method == kDefaultMethod) return "";
  return fmt::format("; method: {}, the default, may lead to a plan", kDefaultMethod);
}

void withdraw_rows(Plan& plan) {
  plan.trajectory.reset();
  plan.certificate.reset();
  plan.solution.reset();
}

// Returns whether the planned rows keep every limit and the task: then a motion exists, and only its accuracy is
// insufficient.
bool keeps_what_was_asked(const Certificate& certificate) {
  const auto kept = [](const LimitCheck& limit) { return limit.passed || limit.reached <= limit.limit; };
  const auto passed = [](const TaskCheck& constraint) { return constraint.passed; };
  return std::all_of(certificate.limits.begin(), certificate.limits.end(), kept) &&
         std::all_of(certificate.task.begin(), certificate.task.end(), passed);
}

// Returns what may help a motion that is not accurate enough.
std::string advice(const std::vector<Relaxation>& relaxations) {
  if (relaxations.empty()) return "";
  const Relaxation& r = relaxations.front();
  const bool by_its_value = r.kind == RelaxableKind::kLimit || r.kind == RelaxableKind::kDuration;
  if (!by_its_value) return "; " + sentence_of(r);
  return fmt::format("; with {} of {}{:.4g} {} (now {:g}) a motion may be found", name_of(r.name, r.joint),
                     r.rough ? "about " : "", r.to, r.unit, r.from);
}

// Returns the reason if rows could not be published because there were too many.
std::string too_many_rows(const Findings& found) { return found.failure.empty() ? "" : "; " + found.failure; }

constexpr const char* kOnCoarseMeshOnly = "the optimiser converged on a coarse mesh, but not on a finer one";

bool is_rough(const std::vector<Relaxation>& relaxations) { return !relaxations.empty() && relaxations.front().rough; }

// Returns whether motions within the limits were found on coarse meshes, and no change is known to be needed: none was
// found, or a rough one by a search that had no more work left. Then it is more likely that motions could not be
// refined than that there are none.
bool only_refining_failed(const Findings& found, const Infeasibility& infeasibility, const Session& session) {
  const bool any = !found.minima.empty() || !found.candidates.empty();
  const bool unsure =
      infeasibility.relaxations.empty() || (is_rough(infeasibility.relaxations) && session.account().cut_by_work);
  return any && unsure && !found.too_short();
}

// Sets status and reason of a search that found nothing certified and was not stopped.
void tell_failure(const Findings& found, const Session& session, Plan& plan) {
  const bool nothing_converged = found.candidates.empty();
  if (plan.infeasibility && plan.certificate && keeps_what_was_asked(*plan.certificate)) {
    plan.reason +=
        advice(plan.infeasibility->relaxations);  // the request is feasible, only the accuracy is insufficient
    plan.infeasibility.reset();
  } else if (plan.infeasibility && plan.certificate && is_rough(plan.infeasibility->relaxations)) {
    plan.reason += "; " + plan.infeasibility->sentence;  // the change is known from motions with smoothed friction only
  } else if (plan.infeasibility && only_refining_failed(found, *plan.infeasibility, session)) {
    const std::string help = advice(plan.infeasibility->relaxations);
    plan.infeasibility.reset();
    if (plan.certificate) return;  // uncertified, with its first failure
    plan.status = PlanStatus::kNotConverged;
    plan.reason = (found.failure.empty() ? kOnCoarseMeshOnly : found.failure) + help;
  } else if (plan.infeasibility) {
    plan.status = PlanStatus::kInfeasible;
    plan.reason = plan.infeasibility->sentence;
    withdraw_rows(plan);  // that motion converged on a coarse mesh only
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
  if (certified && session.deadline_passed()) {  // the plan was certified in time
    plan.cut_by_deadline = true;
  } else if (session.stopped() && !(session.deadline_passed() && plan.infeasibility)) {
    plan.infeasibility.reset();
    plan.status = session.deadline_passed() ? PlanStatus::kDeadline : PlanStatus::kCancelled;
    plan.reason = session.deadline_passed()
                      ? fmt::format("the time budget of {} s was used up{}", session.options().deadline, by_then(found))
                      : "stopped on request" + by_then(found);
    withdraw_rows(plan);
  } else if (!certified || plan.infeasibility) {
    tell_failure(found, session, plan);
    if (plan.certificate) plan.reason += too_many_rows(found);
    const bool explained = plan.status == PlanStatus::kInfeasible && !session.interrupted() && !found.swing_was_cut;
    if (!explained) plan.reason += how_far(found, session);
    if (plan.status != PlanStatus::kInfeasible) plan.reason += other_method(found);
  }
}

}  // namespace fjr
