#include "planner/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "planner/nlp/cpu_time.h"
#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/search/explain/explain.h"
#include "planner/search/fastest.h"
#include "planner/search/findings.h"
#include "planner/search/follow.h"
#include "planner/search/motions.h"
#include "planner/search/refinement.h"

namespace fjr {
namespace {

// Of the work that a request may take, for finding motions; follow.cc has what refining them may take.
constexpr double kFinding = 0.5, kAll = 1;

double most_work(const Problem& problem, const PlanOptions& options) {
  const double usual = starts_worth_trying(problem.weights);
  return std::max(options.most_work * std::max(1.0, options.starts / usual), options.deadline);
}

SessionOptions session_options(const Problem& problem, const PlanOptions& options) {
  SessionOptions o;
  o.settings.linear_solver = options.linear_solver;
  o.settings.scheme = find_scheme(problem.method);
  o.deadline = options.deadline;
  o.most_work = most_work(problem, options);
  o.objective_scale = size_of(problem.weights);
  o.cancelled = options.cancelled;
  o.on_progress = options.on_progress;
  return o;
}

// From the solution of a neighbouring request. Empty when that led to a certified plan; otherwise why it did not, a
// clause.
std::string start_warm(const Collocated& neighbour, Findings& found, Session& session) {
  const Timed timed(session, "warm");
  if (const std::string& method = neighbour.setup.scheme.name; method != found.asked.method) {
    return fmt::format("it was planned with method {}, and {} is asked for", method, found.asked.method);
  }
  std::string refusal;
  for (const auto& alternative : found.alternatives) {
    Continuation c(alternative, session, "from an earlier plan");
    const bool solved = c.resume(neighbour);
    if (solved) {
      PublishResult published = publish(c, found.asked, session);
      if (found.keep(c, std::move(published))) return "";
    }
    if (session.stopped()) return "it was stopped before anything came of it";
    if (c.stages().empty()) {
      refusal = "it passes another number of via points";
    } else if (!solved) {
      refusal = "the optimiser did not converge from it";
    } else {
      const std::string why = found.best ? found.best->certificate.failures.front() : std::string();
      refusal = "what came of it was not certified: " + (found.failure.empty() ? why : found.failure);
    }
  }
  return refusal;
}

// Why there is no plan; where that leads to a motion after all, from there.
std::optional<Infeasibility> find_out_why(Findings& found, Session& session) {
  session.allow(kAll);
  Problem asked = *(found.fastest ? found.fastest->alternative : found.alternatives.front());
  asked.duration = found.asked.duration;
  const auto problem = std::make_shared<const Problem>(std::move(asked));
  const bool certified = found.fastest && found.fastest->certified;
  const WhyNot why =
      explain(*problem, found.fastest ? &found.fastest->motion : nullptr, certified, found.carried_with, session);
  if (why.start && !session.stopped()) {
    found.candidates.clear();
    try_start(problem, *why.start, "from the least slack", found, session);
  }
  return why.infeasibility;
}

// A certified plan, where the search comes to one; otherwise why there is none, as far as that can be told.
std::optional<Infeasibility> search(int starts, Findings& found, Session& session) {
  const auto over = [&] { return found.certified() || session.stopped(); };
  find_motions(starts, found, session);
  if (!over() && !found.candidates.empty() && hurries(found)) {
    found.candidates.clear();
    adopt_fastest(found, session);
  }
  const bool coarse_only = !found.candidates.empty();  // what converged may keep its times on a coarse mesh only
  if (over() || (coarse_only && any_timed(found.asked))) return std::nullopt;
  return find_out_why(found, session);
}

// What was published best, certified or not.
void take_over(const Findings& found, Plan& plan) {
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

// How far the search came, for whoever wants to go on.
std::string how_far(const Findings& found, const Session& session) {
  if (!session.account().cut_by_work) return "";
  return fmt::format(
      "; the search ended where a request may take no more (about {:.0f} s of one core), after {} starts and {} "
      "minima: --deadline allows for more",
      session.options().most_work, found.starts, found.minima.size());
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
  return fmt::format("; with {}{} of {} {} (now {:g}) it may be found", r.name,
                     r.joint == 0 ? "" : fmt::format(" of joint {}", r.joint), enough(r.from, r.to), r.unit, r.from);
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
                                         : "the optimiser converged on a coarse mesh, but not on a finer one";
  }
}

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
    const bool explained = plan.status == PlanStatus::kInfeasible && !session.interrupted();  // all the way
    if (!explained) plan.reason += how_far(found, session);
  }
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

}  // namespace

Plan plan(const Problem& problem, const PlanOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const double began_cpu = cpu_time();
  Session session(session_options(problem, options));
  Findings found(problem);
  Plan plan;

  session.allow(kFinding);
  if (options.warm) {
    plan.warm_refusal = start_warm(*options.warm, found, session);
    plan.warm = plan.warm_refusal.empty();
  }
  if (!plan.warm && !session.stopped()) plan.infeasibility = search(options.starts, found, session);

  take_over(found, plan);
  conclude(found, session, plan);
  if (plan.certificate) {
    const Timed timed(session, "certificate");
    predict(problem.robot, *plan.trajectory, *plan.certificate);
  }
  if (plan.solution && plan.trajectory) plan.analysis = analyse(*found.best->problem, *plan.solution, found.scale);
  tell_account(found, session.account(), plan);
  plan.timing["cpu"] = cpu_since(began_cpu);
  plan.timing["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return plan;
}

}  // namespace fjr
