#include "planner/plan.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "common/cpu_time.h"
#include "planner/certificate/proof/prove.h"
#include "planner/conclusion.h"
#include "planner/plan_fields.h"
#include "planner/search/acceleration_penalty.h"
#include "planner/search/detours.h"
#include "planner/search/explain/explain.h"
#include "planner/search/fastest.h"
#include "planner/search/follow.h"
#include "planner/search/motions.h"
#include "planner/search/robust.h"
#include "planner/search/spare_time.h"
#include "planner/search/starts.h"
#include "planner/search/tracking.h"
#include "planner/search/warm_start.h"

namespace fjr {
namespace {

double most_work(const Problem& problem, const PlanOptions& options) {
  const double usual = starts_worth_trying(problem.weights);
  return std::max(
      options.most_work * std::max(1.0, starts_to_try(problem, options.starts, options.search.starts) / usual),
      options.deadline);
}

// Only the chain factorisation is known to be safe in several threads: MUMPS is not, HSL's may not be.
int threads_for(const PlanOptions& options) {
  if (options.linear_solver != kChainSolver) return 1;
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  return options.jobs > 0 ? options.jobs : std::max(1, cores);
}

SessionOptions session_options(const Problem& problem, const PlanOptions& options) {
  SessionOptions o;
  o.search = options.search;
  o.scheme = find_scheme(problem.method);
  o.linear_solver = options.linear_solver;
  o.deadline = options.deadline;
  o.jobs = threads_for(options);
  o.most_work = most_work(problem, options);
  o.budget_factor = o.most_work / PlanOptions{}.most_work;
  o.objective_scale = objective_scale(problem.weights);
  o.cancelled = options.cancelled;
  o.on_progress = options.on_progress;
  return o;
}

Known known_of(const Findings& found) {
  Known known;
  known.out_of_reach = found.out_of_reach;
  const bool of_same_goal =
      !found.fastest || (found.swing_up && found.fastest->alternative == found.swing_up->alternative);
  if (found.swing_up && of_same_goal) known.reached = found.swing_up->limits;
  if (found.fastest) {
    known.fastest = &found.fastest->motion;
    known.certified = found.fastest->certified;
  }
  return known;
}

// Returns the alternative goal of which it is explained why there is no plan: the one with the fastest motion, or else
// with a swing-up, or else the first one to which obstacles leave a path.
const Problem& alternative_to_explain(const Findings& found) {
  if (found.fastest) return *found.fastest->alternative;
  if (found.swing_up) return *found.swing_up->alternative;
  const auto& all = found.alternatives;
  const auto open =
      all.size() < 2 ? all.end() : std::find_if(all.begin(), all.end(), [](const auto& one) { return !no_path(*one); });
  return open == all.end() ? *all.front() : **open;
}

// Finds out why there is no plan. If the explanation finds a start for the request instead, planning goes on from
// there.
std::optional<Infeasibility> find_out_why(Findings& found, Session& session) {
  session.enter(Phase::kExplaining);
  Problem asked = alternative_to_explain(found);
  asked.duration = found.asked.duration;
  const auto problem = std::make_shared<const Problem>(std::move(asked));
  const WhyNot why = explain(*problem, known_of(found), session);
  if (!why.start || session.stopped()) return why.infeasibility;
  found.candidates.clear();
  try_starts({{problem, *why.start, "from the least change"}}, found, session);
  if (found.certified() || session.interrupted()) return std::nullopt;
  Known known = known_of(found);  // the start may have led to a fastest motion
  known.start_failed = true;
  return explain(*problem, known, session).infeasibility;
}

// Searches for a certified plan; otherwise returns why there is none, if that can be found out.
std::optional<Infeasibility> search(int starts, Findings& found, Session& session) {
  const auto over = [&] { return found.certified() || session.stopped(); };
  WithWait with_wait = plan_with_wait(starts, found, session);
  // A plan with a wait is certified, so that no fallbacks are needed beside it.
  const IfNone if_none = with_wait.best ? IfNone::kGiveUp : IfNone::kFallBack;
  if (!with_wait.is_enough) find_motions(starts, if_none, found, session);
  if (with_wait.best) found.keep(*std::move(with_wait.best));
  if (!over() && !found.candidates.empty() && has_little_spare_time(found, session.settings().fastest)) {
    found.candidates.clear();
    adopt_fastest(found, session);
  }
  fade_acceleration_penalty(found, session);
  if (over()) return std::nullopt;
  const std::vector<CoarseMotion> coarse = found.candidates;  // they may keep times on a coarse mesh only
  std::optional<Infeasibility> why;
  if (coarse.empty() || !any_timed(found.asked)) why = find_out_why(found, session);
  if (over()) return why;
  follow_damped(coarse, found, session);
  fade_acceleration_penalty(found, session);
  return found.certified() ? std::nullopt : why;
}

void withdraw(Plan& plan) {
  plan.status = PlanStatus::kCancelled;
  plan.reason = "stopped on request";
  plan.trajectory.reset();
  plan.certificate.reset();
  plan.solution.reset();
}

// Demands a proof of a certified plan. Without it the plan is not certified. The deadline applies to the search only;
// the proof comes after it.
void demand_proof(const Problem& problem, Session& session, Plan& plan) {
  const Timed timed(session, "proof");
  const TaskOfMotion asked = TaskOfMotion::of(problem.robot, problem.task, plan.segment_ends());
  std::mutex asking;
  bool stopped = false;  // read again when all have ended
  demand_proof(problem.robot, problem.limits, asked, *plan.trajectory, *plan.certificate, session.side_by_side(), [&] {
    const std::lock_guard lock(asking);
    stopped = stopped || (session.options().cancelled && session.options().cancelled());
    return stopped;
  });
  if (plan.certificate->certified) return;
  if (stopped) return withdraw(plan);
  plan.status = PlanStatus::kUncertified;
  plan.reason = plan.certificate->failures.back();
  plan.solution.reset();
}

// Replaces the saving of the parameter that costs most to first order by that of planning again, because shadow prices
// hold for small changes of margins, and these change by up to half.
void plan_largest_saving(const Problem& problem, const Publication& without, const Publication& best, Session& session,
                         Robustness& robustness) {
  auto& [parameter, saving] = robustness.savings.front();
  if (!robustness.kept || saving <= 0) return;
  saving = std::max(0.0, saved_by_half_the_error(parameter, problem, without, best, session).value_or(saving));
}

}  // namespace

Plan plan(const Problem& problem, const PlanOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const double began_cpu = cpu_time();
  const Problem searched = without_closed_loop(problem);
  Session session(session_options(searched, options));
  Findings found(searched, options.search.follow);
  Plan plan;
  plan.settings = options.search;

  session.enter(Phase::kFinding);
  if (options.warm) {
    plan.warm_name = options.warm->name;
    plan.warm_away = options.warm->away;
    plan.warm_refusal = start_warm(*options.warm->solution, found, session);
    plan.warm = !plan.warm_refusal;
  }
  if (!plan.warm && !session.stopped()) plan.infeasibility = search(options.starts, found, session);

  lower_tracking_error(problem, found, session);
  const std::optional<Publication> without_margins = make_robust(problem, found, session);
  tell_motion(found, plan);
  conclude(found, session, plan);
  if ((options.proven || problem.proven) && plan.status == PlanStatus::kCertified) demand_proof(problem, session, plan);
  if (plan.solution && plan.trajectory) plan.analysis = analyse(*found.best->problem, *plan.solution, found.scale);
  if (plan.analysis && plan.certificate->robustness.evaluated) {
    tell_savings(*plan.analysis, plan.certificate->robustness);
    plan_largest_saving(problem, *without_margins, *found.best, session, plan.certificate->robustness);
  }
  tell_account(found, session.account(), plan);
  plan.timing["cpu"] = cpu_since(began_cpu) + session.account().cpu_of_others;
  plan.timing["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return plan;
}

}  // namespace fjr
