#include "planner/program/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "planner/certificate/limits.h"
#include "planner/problem/quantities.h"

namespace fjr {
namespace {

constexpr std::size_t kTightest = 3;  // limits shown
constexpr double kOnePercent = 0.01;  // change of a limit, small enough for its first-order shadow price
// Fraction of the objective. Limits whose product with their shadow price is smaller are left out.
constexpr double kPriceTelling = 0.005;

std::string line(std::string_view label, const std::string& text) { return fmt::format("  {:<11} {}\n", label, text); }

// The tolerance is one count of the link encoder.
std::string exactness(const RolloutErrors& errors, double tolerance) {
  if (!errors.completed) return "not completed: " + errors.failure;
  return fmt::format("link {:.3f} counts ({:.2e} rad) at {:.4f} s, at the end {:.3f} counts; motor {:.2e} rad",
                     errors.max_link() / tolerance, errors.max_link(), errors.time_of_max_link,
                     errors.max_final_link() / tolerance, errors.max_motor());
}

std::string open_loop(const OpenLoop& errors, double tolerance) {
  const std::string text = exactness(errors, tolerance), reason = errors.why_not_in_one_run();
  return reason.empty() ? text : fmt::format("{} (not in one run: {})", text, reason);
}

std::string after_perturbed(const Perturbed& perturbed, double tolerance) {
  const double after = std::max(perturbed.after[0], perturbed.after[1]);
  return after == 0 ? "" : fmt::format(", in the second after the end {:.3f} counts", after / tolerance);
}

std::string proven_loop(const char* name, const Proof::Loop& loop, double tolerance) {
  const std::string until = loop.proven ? "" : fmt::format(" until {:.4f} s", loop.until);
  return fmt::format("{} link at most {:.4f} counts{}, known to {:.1e} rad", name,
                     std::max(loop.link[0], loop.link[1]) / tolerance, until, loop.width);
}

std::string proof(const Proof& proof, double tolerance) {
  const std::string loops = fmt::format("{}; {}", proven_loop("open loop", proof.open_loop, tolerance),
                                        proven_loop("closed loop", proof.closed_loop, tolerance));
  std::string text = proof.proven ? line("proven", "at all times: " + loops) : line("not proven", loops);
  if (!proof.proven) return text;  // the task was checked only until the proof stopped
  for (const TaskBound& bound : proof.task) {
    text += line("", fmt::format("{}{} keeps a clearance of at least {:.3g} {}, the exact motion {:.3g}", bound.name,
                                 bound.link == 0 ? "" : fmt::format(" link {}", bound.link), bound.published,
                                 bound.unit, bound.rollout));
  }
  return text;
}

std::string margin(const Robustness::Margin& m) {
  const std::string joint = m.joint == 0 ? "" : fmt::format("{} {}", std::isfinite(m.limit) ? "" : " link", m.joint);
  const std::string costs = m.parameter.empty()
                                ? "most of it for encoder counts and ticks"
                                : fmt::format("{:.0f} % of its square for {}", 100 * m.fraction, m.parameter);
  return fmt::format("{}{} needs {:.3g}, has {:.3g} {} at {:.4f} s; {}", m.name, joint, m.needed, m.there, m.unit,
                     m.time, costs);
}

// Returns what holds for most of the arms that the identification leaves possible.
std::string robustness(const Robustness& r, double tolerance) {
  std::string text = line(
      r.kept ? "robust" : "not robust",
      fmt::format("probability {} over {} uncertain parameters: links within {:.1f} and {:.1f} counts{}", r.confidence,
                  r.parameters, r.link[0] / tolerance, r.link[1] / tolerance, r.kept ? ", and no limit exceeded" : ""));
  std::vector<Robustness::Margin> margins = r.limits;
  margins.insert(margins.end(), r.task.begin(), r.task.end());
  std::stable_sort(margins.begin(), margins.end(),
                   [](const auto& a, const auto& b) { return a.there * b.needed < b.there * a.needed; });
  margins.resize(std::min(margins.size(), kTightest));
  for (const Robustness::Margin& m : margins) text += line("", margin(m));
  if (!r.costs.empty()) {
    text += line(
        "", fmt::format("{} widens the margins most; not covered: {}", r.costs.front().first, Robustness::kNotCovered));
  }
  return text;
}

std::string limit_text(const LimitCheck& check, const Limits& limits) {
  const std::string joint = check.joint == 0 ? "" : fmt::format(" {}", check.joint);
  return fmt::format("{}{} {:.6g} of {:.6g} {} at {:.4f} s{}", check.name, joint, check.reached, check.limit,
                     unit_of_limit(check.name), check.time, counted_from(check, limits));
}

std::string tightest_limits(const Certificate& certificate, const Limits& limits) {
  std::vector<LimitCheck> checks;
  std::copy_if(certificate.limits.begin(), certificate.limits.end(), std::back_inserter(checks),
               [](const LimitCheck& check) { return std::isfinite(check.limit) && check.limit > 0; });
  std::stable_sort(checks.begin(), checks.end(),
                   [](const LimitCheck& a, const LimitCheck& b) { return a.reached / a.limit > b.reached / b.limit; });
  checks.resize(std::min(checks.size(), kTightest));
  std::string text;
  for (const LimitCheck& check : checks) text += line(text.empty() ? "tightest" : "", limit_text(check, limits));
  return text;
}

// Returns the terms with a weight, or all others.
std::string terms(const Problem& problem, const Plan& plan, bool that_count) {
  std::string text;
  for (const TermInfo& term : Terms::infos) {
    const auto found = plan.terms.find(term.name);
    const double weight = signed_weight(problem.weights, term);
    if (found == plan.terms.end() || (weight != 0) != that_count) continue;
    if (!that_count && !(std::isfinite(found->second) && found->second != 0)) continue;
    text += fmt::format("{}{} {:.6g} {}{}", text.empty() ? "" : ", ", term.name, found->second, term.unit,
                        that_count ? fmt::format(" x {:g}", weight) : "");
  }
  return text;
}

// Two digits, and no exponent where it is more than 100.
std::string percent(double fraction) {
  const double percents = 100 * fraction;
  return std::abs(percents) < 99.5 ? fmt::format("{:.2g} %", percents) : fmt::format("{:.0f} %", percents);
}

std::string gain(const Problem& problem, const Plan& plan, double objective) {
  if (only_time(problem.weights)) return fmt::format("{:.3g} ms", 1e3 * objective / problem.weights.time);
  return fmt::format("{:.3g} ({})", objective, percent(objective / std::abs(plan.objective)));
}

// Returns what margins for other arms cost, and how much of it knowing the costliest parameter better would give back.
std::string what_robustness_costs(const Problem& problem, const Plan& plan) {
  const Robustness& r = plan.certificate->robustness;
  if (!r.price || r.savings.empty()) return "";
  const std::string of = only_time(problem.weights) ? fmt::format(" of {:.3g}", 1e3 * plan.duration) : "";
  std::string text = fmt::format("{}{} for a probability of {}", gain(problem, plan, *r.price), of, r.confidence);
  if (r.savings.front().second > 0) {
    text += fmt::format("; {} of it for {}, if that were known twice as well",
                        gain(problem, plan, r.savings.front().second), r.savings.front().first);
  }
  return line("margins", text);
}

// Returns the limits that cost most, and the duration if it is prescribed: to first order, from the multipliers.
std::string what_limits(const Problem& problem, const Plan& plan) {
  const Sensitivity& sensitivity = plan.analysis->sensitivity;
  std::vector<ShadowPrice> limits;
  std::copy_if(sensitivity.limits.begin(), sensitivity.limits.end(), std::back_inserter(limits),
               [&](const ShadowPrice& l) { return l.price * l.limit > kPriceTelling * std::abs(plan.objective); });
  std::stable_sort(limits.begin(), limits.end(),
                   [](const ShadowPrice& a, const ShadowPrice& b) { return a.price * a.limit > b.price * b.limit; });
  limits.resize(std::min(limits.size(), kTightest));
  std::string text;
  const auto add = [&text](const std::string& sentence) { text += line(text.empty() ? "limiting" : "", sentence); };
  for (const ShadowPrice& l : limits) {
    const bool of_task = l.index >= kLimits;
    const std::string joint = l.joint == 0 ? "" : fmt::format("{} {}", of_task ? " link" : "", l.joint);
    add(fmt::format("{}{} {:.0f} % of the time: 1 % more{}, {:.3g} {}, would save {}", l.name, joint, 100 * l.fraction,
                    of_task ? " clearance" : "", kOnePercent * l.limit, l.unit,
                    gain(problem, plan, kOnePercent * l.limit * l.price)));
  }
  if (sensitivity.duration) {
    const double slope = *sensitivity.duration, step = kOnePercent * plan.duration;
    add(fmt::format("duration: 1 % {}, {:.3g} ms, would save {}", slope < 0 ? "more" : "less", 1e3 * step,
                    gain(problem, plan, step * std::abs(slope))));
  }
  return text;
}

// Returns how far the plan is from the optimum of the requested problem, as far as the optimality conditions show.
std::string optimality(const Plan& plan) {
  const Optimality& o = plan.analysis->optimality;
  const auto& h = o.hamiltonian;
  const double size = std::abs(plan.objective) / plan.duration;
  std::string text;
  if (!h.stationary()) {
    text += line("optimality",
                 fmt::format("not stationary: the Hamiltonian varies by {} of objective / duration, {} at "
                             "most would count as constant: a better motion may be near, and shadow prices are rough",
                             percent(h.spread / size), percent(h.allowed / size)));
  }
  if (o.friction_width > 0) {
    text += line("friction", fmt::format("optimised with the law smoothed to {:.2g} rad/s; published, and judged, with "
                                         "the exact one",
                                         o.friction_width));
  }
  return text;
}

// Returns the minima that the starts found, before the best were refined.
std::string minima(const Plan& plan) {
  const double best = plan.minima.front(), spread = plan.minima.back() - best;
  return fmt::format("{} met, from {:.6g} to {:.6g} ({} apart) on their first meshes", plan.minima.size(), best,
                     plan.minima.back(), percent(spread / std::max(std::abs(best), 1e-300)));
}

// Returns the earlier plan that this one was started from.
std::string earlier(const Plan& plan) {
  return plan.warm_away ? fmt::format("the library's {} ({:.2g} rad away)", plan.warm_name, *plan.warm_away)
                        : std::string("the earlier plan");
}

std::string effort(const Plan& plan) {
  const auto total = plan.timing.find("total");
  const std::string time = total == plan.timing.end() ? "" : fmt::format(", {:.3f} s", total->second);
  const std::string mesh = plan.intervals == 0 ? "" : fmt::format(", {} intervals {}", plan.intervals, plan.method);
  const auto count = [](int n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); };
  return fmt::format("{}, {}{}{}", count(plan.iterations, "iteration"),
                     plan.warm ? "from " + earlier(plan) : count(plan.starts, "start"), mesh, time);
}

// Returns whether the earlier plan was of use, whether the allowed time was used up, and whether another objective was
// optimised.
std::string search(const Plan& plan) {
  std::string text;
  if (plan.warm_refusal) {
    text += line("warm", fmt::format("planned from scratch, because {} could not be used: {}", earlier(plan),
                                     *plan.warm_refusal));
  }
  if (plan.cut_by_deadline) {
    text += line("search", fmt::format("cut by the deadline after {} of {} starts, with {} of {} minima refined: more "
                                       "time may find a better motion",
                                       plan.starts, plan.starts_planned, plan.refined, plan.minima.size()));
  }
  constexpr double kWorthTelling = 0.01;  // of the objective
  if (const double added = plan.acceleration_penalty / std::abs(plan.objective); added > kWorthTelling) {
    text +=
        line("search", fmt::format("found with a penalty on accelerations, which adds {:.2g} % to what was optimised: "
                                   "a longer --deadline may find a better motion",
                                   100 * added));
  }
  return text;
}

}  // namespace

std::string summary(const Certificate& certificate, const Limits& limits) {
  const auto& feedback = certificate.closed_loop.feedback_torque;
  std::string text =
      line("exactness", fmt::format("allowed: 1 count of the link encoder = {:.3e} rad", certificate.tolerance));
  text += line("open loop", open_loop(certificate.open_loop, certificate.tolerance));
  text += line("closed loop", exactness(certificate.closed_loop, certificate.tolerance));
  if (const Perturbed& perturbed = certificate.closed_loop.perturbed; perturbed.evaluated) {
    text += line("perturbed", fmt::format("from half a count off the start: link {:.3f} counts at {:.4f} s{}",
                                          perturbed.max_link() / certificate.tolerance, perturbed.time_of_max_link,
                                          after_perturbed(perturbed, certificate.tolerance)));
  }
  text += line("feedback", fmt::format("at most {:.2e} and {:.2e} N m", feedback[0], feedback[1]));
  text += tightest_limits(certificate, limits);
  for (const TaskCheck& check : certificate.task) {
    text += line(text.find("task") == std::string::npos ? "task" : "",
                 fmt::format("{}{} keeps a clearance of {:.3g} {} at {:.4f} s", check.name,
                             check.link == 0 ? "" : fmt::format(" link {}", check.link), check.clearance, check.unit,
                             check.time));
  }
  if (certificate.residual.evaluated) {
    const auto& after = certificate.residual;
    text += line("afterwards", fmt::format("links within {:.2e} and {:.2e} rad of the goal for {:g} s",
                                           after.link_vibration[0], after.link_vibration[1], after.window));
  }
  const auto& tracking = certificate.tracking;
  text += line(
      "on hardware",
      fmt::format("predicted: links within {:.1f} and {:.1f} counts, motors at most {:.4g} and {:.4g} N m{}",
                  tracking.link_error[0] / certificate.tolerance, tracking.link_error[1] / certificate.tolerance,
                  tracking.peak_torque[0], tracking.peak_torque[1], tracking.saturated ? " (the drive's peak)" : ""));
  if (certificate.proof.evaluated) text += proof(certificate.proof, certificate.tolerance);
  if (certificate.robustness.evaluated) text += robustness(certificate.robustness, certificate.tolerance);
  for (const std::string& failure : certificate.failures) text += line("failed", failure);
  return text;
}

std::string summary(const Problem& problem, const Plan& plan) {
  std::string text =
      fmt::format("{}: {}{}\n", problem.name, name(plan.status), plan.reason.empty() ? "" : ": " + plan.reason);
  if (plan.trajectory) {
    text += line("duration", fmt::format("{:.6g} s", plan.duration));
    text += line("objective", fmt::format("{:.6g} ({})", plan.objective, terms(problem, plan, true)));
    text += line("besides", terms(problem, plan, false));
  }
  if (plan.certificate) text += summary(*plan.certificate, problem.limits);
  if (plan.analysis) text += what_robustness_costs(problem, plan) + what_limits(problem, plan) + optimality(plan);
  if (plan.minima.size() > 1) text += line("minima", minima(plan));
  text += line("solver", effort(plan));
  text += search(plan);
  return text;
}

}  // namespace fjr
