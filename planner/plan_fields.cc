#include "planner/plan_fields.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/search/refinement.h"

namespace fjr {
namespace {

// Returns the mean of values given at these times [s] over those times at which a limit is active.
double mean_while_active(const ShadowPrice& limit, const std::vector<double>& times,
                         const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (const ShadowPrice::Stretch& stretch : limit.active) {
      if (times[k] < stretch.begin || times[k] > stretch.end) continue;
      sum += values[k];
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

// Returns what the motion's problem adds to the objective beyond what was asked for, in the unit of that.
double acceleration_penalty(const Findings& found, const Publication& best) {
  const Weights &solved = best.problem->weights, &asked = found.asked.weights;
  const auto added = [&](double Weights::*weight, const char* term) {
    const double more = solved.*weight - asked.*weight / found.scale;
    return more > 0 ? more * found.scale * best.terms.at(term) : 0;
  };
  return added(&Weights::link_acceleration, "link_acceleration") + added(&Weights::link_jerk, "link_jerk");
}

}  // namespace

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
  plan.acceleration_penalty = acceleration_penalty(found, best);
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

void tell_savings(const Analysis& analysis, Robustness& robustness) {
  std::vector<double> gains(robustness.names.size(), 0.0);
  std::vector<bool> counted(analysis.sensitivity.limits.size(), false);
  for (const auto* margins : {&robustness.limits, &robustness.task}) {
    for (const Robustness::Margin& m : *margins) {
      for (std::size_t l = 0; l < counted.size(); ++l) {
        const ShadowPrice& limit = analysis.sensitivity.limits[l];
        if (counted[l] || limit.index != m.index || limit.price == 0) continue;
        if (std::isfinite(m.limit) && m.limit > limit.limit)
          continue;  // kept by the limit with feedback, so it costs nothing
        counted[l] = true;
        for (std::size_t i = 0; i < gains.size(); ++i) {
          gains[i] += limit.price * mean_while_active(limit, robustness.times, m.halved[i]);
        }
      }
    }
  }
  for (std::size_t i = 0; i < gains.size(); ++i) robustness.savings.emplace_back(robustness.names[i], gains[i]);
  std::stable_sort(robustness.savings.begin(), robustness.savings.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
}

void tell_account(const Findings& found, const Account& account, Plan& plan) {
  plan.stages = account.stages;
  plan.iterations = account.iterations;
  plan.cost = account.cost;
  plan.fallbacks = account.fallbacks;
  plan.cut_by_work = account.cut_by_work;
  plan.starts = found.starts;
  plan.starts_planned = std::max(found.starts_planned, found.starts);  // fallbacks are starts, too
  plan.refined = found.refined;
  plan.minima = found.minima;
  std::sort(plan.minima.begin(), plan.minima.end());
  for (double& objective : plan.minima) objective *= found.scale;
  plan.timing = account.timing;
  plan.timing["evaluation"] = account.cost.evaluation;
  plan.timing["linear_algebra"] = account.cost.linear_algebra;
  plan.timing["ipopt"] = account.cost.in_optimiser();
}

}  // namespace fjr
