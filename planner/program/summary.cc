#include "planner/program/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

namespace fjr {
namespace {

constexpr std::size_t kTightest = 3;  // limits shown

std::string_view unit_of(std::string_view name) {
  if (name == "torque") return "N m";
  if (name == "motor_velocity") return "rad/s";
  if (name == "torque_rate") return "N m/s";
  if (name == "tip_speed") return "m/s";
  return "rad";
}

std::string line(std::string_view label, const std::string& text) { return fmt::format("  {:<11} {}\n", label, text); }

// The tolerance is one count of the link encoder.
std::string exactness(const RolloutErrors& errors, double tolerance) {
  if (!errors.completed) return "not completed: " + errors.failure;
  return fmt::format("link {:.3f} counts ({:.2e} rad) at {:.4f} s, at the end {:.3f} counts; motor {:.2e} rad",
                     errors.max_link() / tolerance, errors.max_link(), errors.time_of_max_link,
                     errors.max_final_link() / tolerance, errors.max_motor());
}

std::string open_loop(const OpenLoop& errors, double tolerance) {
  const std::string text = exactness(errors, tolerance);
  return errors.required ? text : fmt::format("{} (not required: {})", text, errors.why_not);
}

std::string limit_text(const LimitCheck& check) {
  const std::string joint = check.joint == 0 ? "" : fmt::format(" {}", check.joint);
  return fmt::format("{}{} {:.6g} of {:.6g} {} at {:.4f} s", check.name, joint, check.reached, check.limit,
                     unit_of(check.name), check.time);
}

std::string tightest_limits(const Certificate& certificate) {
  std::vector<LimitCheck> checks;
  std::copy_if(certificate.limits.begin(), certificate.limits.end(), std::back_inserter(checks),
               [](const LimitCheck& check) { return std::isfinite(check.limit) && check.limit > 0; });
  std::stable_sort(checks.begin(), checks.end(),
                   [](const LimitCheck& a, const LimitCheck& b) { return a.reached / a.limit > b.reached / b.limit; });
  checks.resize(std::min(checks.size(), kTightest));
  std::string text;
  for (const LimitCheck& check : checks) text += line(text.empty() ? "tightest" : "", limit_text(check));
  return text;
}

std::string terms(const Problem& problem, const Plan& plan) {
  std::string text;
  for (const TermInfo& term : Terms::infos) {
    const auto found = plan.terms.find(term.name);
    const double weight = signed_weight(problem.weights, term);
    if (found == plan.terms.end() || (weight == 0 && !std::isfinite(found->second))) continue;
    text += fmt::format("{}{} {:.6g} {}{}", text.empty() ? "" : ", ", term.name, found->second, term.unit,
                        weight != 0 ? fmt::format(" x {:g}", weight) : "");
  }
  return text;
}

std::string effort(const Plan& plan) {
  const auto total = plan.timing.find("total");
  const std::string time = total == plan.timing.end() ? "" : fmt::format(", {:.3f} s", total->second);
  const std::string mesh = plan.intervals == 0 ? "" : fmt::format(", {} intervals {}", plan.intervals, plan.method);
  return fmt::format("{} iterations, {} start{}{}{}", plan.iterations, plan.starts, plan.starts == 1 ? "" : "s", mesh,
                     time);
}

}  // namespace

std::string summary(const Certificate& certificate) {
  const auto& feedback = certificate.closed_loop.feedback_torque;
  std::string text =
      line("exactness", fmt::format("allowed: 1 count of the link encoder = {:.3e} rad", certificate.tolerance));
  text += line("open loop", open_loop(certificate.open_loop, certificate.tolerance));
  text += line("closed loop", exactness(certificate.closed_loop, certificate.tolerance));
  text += line("feedback", fmt::format("at most {:.2e} and {:.2e} N m", feedback[0], feedback[1]));
  text += tightest_limits(certificate);
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
  for (const std::string& failure : certificate.failures) text += line("failed", failure);
  return text;
}

std::string summary(const Problem& problem, const Plan& plan) {
  std::string text =
      fmt::format("{}: {}{}\n", problem.name, name(plan.status), plan.reason.empty() ? "" : ": " + plan.reason);
  if (plan.trajectory) {
    text += line("duration", fmt::format("{:.6g} s", plan.duration));
    text += line("objective", fmt::format("{:.6g} ({})", plan.objective, terms(problem, plan)));
  }
  if (plan.certificate) text += summary(*plan.certificate);
  text += line("solver", effort(plan));
  return text;
}

}  // namespace fjr
