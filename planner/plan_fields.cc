#include "planner/plan_fields.h"

#include <algorithm>

#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/search/refinement.h"

namespace fjr {

void tell_motion(const Findings& found, Plan& plan) {
  if (!found.best) return;
  const Publication& best = *found.best;
  const Collocated& solution = best.solution;
  plan.status = best.certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified;
  plan.reason = best.certificate.certified ? "" : best.certificate.failures.front();
  plan.duration = best.trajectory.end_time();
  plan.via_times = segment_ends(solution.durations);
  plan.via_times.pop_back();
  plan.objective = best.objective;
  plan.terms = best.terms;
  plan.intervals = static_cast<int>(solution.setup.mesh.size());
  plan.method = solution.setup.scheme.name;
  plan.node_times = solution.setup.mesh.node_times(solution.durations);
  plan.interval_errors = interval_errors(found.asked.robot, solution.motion);
  plan.error_estimate = *std::max_element(plan.interval_errors.begin(), plan.interval_errors.end());
  plan.back_off = largest_tightening(found.asked, solution.setup.margins);
  plan.trajectory = best.trajectory;
  plan.certificate = best.certificate;
  if (best.certificate.certified) plan.solution = std::make_shared<const Collocated>(solution);
}

void tell_account(const Findings& found, const Account& account, Plan& plan) {
  plan.stages = account.stages;
  plan.iterations = account.iterations;
  plan.cost = account.cost;
  plan.fallbacks = account.fallbacks;
  plan.cut_by_work = account.cut_by_work;
  plan.starts = found.starts;
  plan.starts_planned = found.starts_planned;
  plan.refined = found.refined;
  plan.minima = found.minima;
  std::sort(plan.minima.begin(), plan.minima.end());
  for (double& objective : plan.minima) objective *= found.scale;
  plan.timing = account.timing;
  plan.timing["evaluation"] = account.cost.evaluation;
  plan.timing["linear_algebra"] = account.cost.linear_algebra;
  plan.timing["ipopt"] = account.cost.ipopt();
}

}  // namespace fjr
