#include "planner/program/identify_executed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/input_error.h"
#include "common/parallel.h"
#include "common/say.h"
#include "planner/identify/executed.h"
#include "planner/identify/executed_robot.h"
#include "planner/program/doubts.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

using ExecutedJson = nlohmann::ordered_json;

constexpr double kDoubtfulMove = 3;  // standard errors of robot.yaml: a parameter that moves further is doubtful
// Deviation of readings from the fitted arm, relative to the effect of encoder counts, above which there are other
// errors. Counts alone make 0.98 to 1.02 with some thousand readings.
constexpr double kUnmodelled = 1.2;

std::vector<ExecutedMotion> motions_in(const ExecutedArguments& options) {
  std::vector<ExecutedMotion> motions;
  std::string first_arm;
  for (const std::string& file : options.logs) {
    const Log log = read_log(file, options.renamed);
    for (const ExecutedMotion& other : motions) {
      if (other.hash == log.hash) throw InputError(file, "", "is the same log as " + other.log);
    }
    const auto id = log.metadata.find("robot_id");
    const std::string arm = id == log.metadata.end() ? "" : id->second;
    if (motions.empty()) first_arm = arm;
    if (arm != first_arm) {
      throw InputError(file, "# robot_id",
                       fmt::format("'{}' is not the arm of {}, '{}'", arm, options.logs[0], first_arm));
    }
    motions.push_back(executed_motion(log));
  }
  return motions;
}

std::vector<std::string> warnings_about(const ExecutedFit& fit) {
  std::vector<std::string> all;
  if (!fit.converged)
    all.emplace_back("the fit did not converge: these are not the most likely values, and are not written");
  const double off = std::sqrt(fit.chi_square);
  if (off > kUnmodelled) {
    all.push_back(
        fmt::format("the encoders are off the refined arm by {:.2g} times what their counts make: the springs' "
                    "hysteresis, link damping, temperature or something else that the model or the fit has not; "
                    "standard errors are told larger by as much, and may still be too small",
                    off));
  }
  for (const RefinedParameter& p : fit.parameters) {
    if (p.assumed || std::abs(p.standard_errors_moved()) < kDoubtfulMove) continue;
    all.push_back(
        fmt::format("{} moved by {:.2g} of the standard errors that the robot file has: it contradicts the motions; "
                    "--widen makes them larger",
                    p.name, std::abs(p.standard_errors_moved())));
  }
  return all;
}

std::string table_of(const ExecutedFit& fit) {
  std::string text = fmt::format("  {:<26} {:>12} {:>12}  {:<12} {}\n", "parameter", "before", "after", "unit", "+-");
  for (const RefinedParameter& p : fit.parameters) {
    const double left = p.error / p.prior_error;
    text +=
        fmt::format("  {:<26} {:>12.6g} {:>12.6g}  {:<12} {:<9.2g} {}\n", p.name, p.before, p.after, p.unit, p.error,
                    p.refined() ? fmt::format("refined by the motions, {:.2g} of {} is left", left,
                                              p.assumed ? "the assumed error" : "its error")
                                : fmt::format("kept: these motions do not tell, {:.2g} of {} is left", left,
                                              p.assumed ? "the assumed error" : "its error"));
  }
  return text;
}

std::string motions_table(const ExecutedFit& fit, const std::vector<ExecutedMotion>& motions) {
  std::string text;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Refit& refit = fit.motions[i];
    text += fmt::format(
        "  {}\n    links off the plan           {:.3g} and {:.3g} rad rms, as executed\n"
        "    links off the arm known      {:.3g} and {:.3g} rad rms, under the logged torques\n"
        "    links off the arm refined    {:.3g} and {:.3g} rad rms\n"
        "    motors off the arm refined   {:.3g} and {:.3g} rad rms\n",
        motions[i].log, motions[i].link_error_rms[0], motions[i].link_error_rms[1], refit.before[0], refit.before[1],
        refit.after[0], refit.after[1], refit.after[2], refit.after[3]);
  }
  return text;
}

ExecutedJson fit_json(const ExecutedFit& fit, const std::vector<ExecutedMotion>& motions) {
  ExecutedJson json{{"procedure", "executed"}};
  for (const RefinedParameter& p : fit.parameters) {
    json["parameters"][p.name] = {{"unit", p.unit},
                                  {"before", p.before},
                                  {"standard_error_before", p.prior_error},
                                  {"standard_error_assumed", p.assumed},
                                  {"value", p.after},
                                  {"standard_error", p.error},
                                  {"refined", p.refined()}};
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const auto pair = [](double first, double second) { return ExecutedJson{first, second}; };
    const Refit& refit = fit.motions[i];
    json["motions"].push_back({{"log", motions[i].log},
                               {"sha256", motions[i].hash},
                               {"ticks", motions[i].times.size()},
                               {"link_error_rms", motions[i].link_error_rms},
                               {"links_off_before_rms", pair(refit.before[0], refit.before[1])},
                               {"links_off_rms", pair(refit.after[0], refit.after[1])},
                               {"motors_off_rms", pair(refit.after[2], refit.after[3])}});
  }
  json["readings"] = fit.readings;
  json["chi_square"] = fit.chi_square;
  json["converged"] = fit.converged;
  json["warnings"] = warnings_about(fit);
  return json;
}

}  // namespace

int identify_executed(const ExecutedArguments& options) {
  const std::filesystem::path base =
      options.robot.empty() ? default_robot_file() : std::filesystem::path(options.robot);
  const Parameters known = load_parameters(base);
  const std::vector<ExecutedMotion> motions = motions_in(options);
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const ExecutedFit fit =
      fit_executed(known, prior_of(known, options.widen, options.payload), motions,
                   [&](std::size_t count, const auto& task) { for_each_index(count, threads, task); });
  if (!options.json) {
    say_in(stdout, "executed, {} motions\n{}{}  chi^2 {:.3g} per degree of freedom of {} readings\n", motions.size(),
           table_of(fit), motions_table(fit, motions), fit.chi_square, fit.readings);
  }
  for (const std::string& warning : warnings_about(fit)) say("fjr: warning: {}\n", warning);
  const bool written = fit.converged && !options.out.empty();
  if (written) tell_doubts(write_executed_robot(options.out, base, fit, motions));
  if (options.json) {
    fmt::print("{}", json_text(fit_json(fit, motions)));
  } else if (written) {
    fmt::print("{}\n", options.out);
  }
  return fit.converged ? 0 : 1;
}

}  // namespace fjr
