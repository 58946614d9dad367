#include "planner/program/experiment_design.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/say.h"
#include "planner/design/experiment_design.h"
#include "planner/plan.h"
#include "planner/program/doubts.h"
#include "planner/program/interrupt.h"
#include "planner/program/progress_line.h"
#include "planner/results/plan_json.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using DesignJson = nlohmann::ordered_json;

fs::path empty_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories(name, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", name, error.message()));
  if (!fs::is_empty(name, error) || error) {
    throw InputError("--out", "", fmt::format("{} has files already; name a folder that is empty or not there", name));
  }
  return name;
}

std::string request_name(std::size_t motion) { return fmt::format("{:02}.yaml", motion + 1); }

DesignJson to_json(const ExperimentDesign& design, const Prior& prior) {
  DesignJson json{{"duration", design.duration()}};
  for (std::size_t i = 0; i < design.motions.size(); ++i) {
    const Trajectory& trajectory = design.motions[i].trajectory;
    json["motions"].push_back(
        {{"request", request_name(i)}, {"duration", trajectory.end_time() - trajectory.start_time()}});
  }
  for (std::size_t i = 0; i < prior.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    json["parameters"][prior.names[i]] = {{"unit", unit_of(prior.names[i])},
                                          {"standard_error_before", prior.deviation[k]},
                                          {"standard_error_assumed", static_cast<bool>(prior.assumed[i])},
                                          {"standard_error", design.error[k]}};
  }
  return json;
}

std::string for_people(const ExperimentDesign& design, const Prior& prior, const fs::path& folder) {
  std::string text = fmt::format("{} motions, {:.3f} s together: {} to {}\n", design.motions.size(), design.duration(),
                                 (folder / request_name(0)).string(), request_name(design.motions.size() - 1));
  text += fmt::format("  {:<26} {:>12} {:>12}  {}\n", "standard error of", "before", "after", "unit");
  for (std::size_t i = 0; i < prior.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    text += fmt::format("  {:<26} {:>12.2g} {:>12.2g}  {}{}\n", prior.names[i], prior.deviation[k], design.error[k],
                        unit_of(prior.names[i]), prior.assumed[i] ? "  (before: assumed)" : "");
  }
  return text;
}

DesignOptions options_of(const ExperimentDesignArguments& arguments, ProgressLine& line) {
  DesignOptions options;
  if (!arguments.start.empty()) options.start = {arguments.start[0], arguments.start[1]};
  options.duration = arguments.duration;
  options.candidates = arguments.candidates;
  options.seed = arguments.seed;
  options.on_progress = [&line](double done) { line.show(done); };
  options.cancelled = interrupted;
  return options;
}

}  // namespace

int experiment_design(const ExperimentDesignArguments& arguments) {
  const Parameters robot = load_parameters(arguments.robot.empty() ? default_robot_file() : fs::path(arguments.robot));
  tell_doubts(robot);
  const fs::path folder = empty_folder(arguments.out);
  const Prior prior =
      prior_of(robot, arguments.widen, arguments.payload_known ? PayloadMass::kKnown : PayloadMass::kUncertain);
  catch_interrupts();
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  ExperimentDesign design;
  {
    ProgressLine line("experiment design");
    design = design_experiment(robot, prior, options_of(arguments, line),
                               [&](std::size_t count, const auto& task) { for_each_index(count, threads, task); });
  }
  if (interrupted()) {
    say("fjr: experiment design: cancelled; nothing was written\n");
    return exit_code(PlanStatus::kCancelled);
  }
  for (std::size_t i = 0; i < design.motions.size(); ++i) {
    Request request = design.motions[i].request;
    if (!arguments.robot.empty()) request.robot = fs::absolute(arguments.robot).string();
    write_file(folder / request_name(i), format_request(request));
  }
  const DesignJson json = to_json(design, prior);
  write_file(folder / "design.json", json_text(json));
  fmt::print("{}", arguments.json ? json_text(json) : for_people(design, prior, folder));
  return 0;
}

}  // namespace fjr
