// fjr simulate: runs any trajectory file on the simulated arm.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "model/encoder.h"
#include "model/log.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/consistency.h"
#include "planner/certificate/run_figures.h"
#include "planner/certificate/simulation.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/file_checks.h"
#include "planner/program/misspelt.h"
#include "planner/program/number_checks.h"
#include "planner/protocol/execution_messages.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"

namespace fjr {
namespace {

using SimulationJson = nlohmann::ordered_json;

constexpr double kLongestHold = 10;      // [s] with a motion of 20 s no more rows than a trajectory file may have
constexpr double kRowPeriod = 0.999e-3;  // [s] between rows that are written, at least

struct SimulateArguments {
  std::string trajectory, out, log;
  std::string robot, true_robot;  // empty: the default; the same as `robot`
  std::string control = "closed-loop";
  double hold = 1;  // [s]
  bool json = false;
};

struct SimulatedRun {
  Parameters robot;  // what the trajectory is for
  Trajectory trajectory;
  double hold = 0;  // [s] 0: the trajectory does not end at rest, or in open loop
  Simulation simulation;
  RunFigures figures;
};

ControlMode control_named(const std::string& name) {
  if (name == "open-loop") return ControlMode::kOpenLoop;
  return name == "executor" ? ControlMode::kExecutor : ControlMode::kClosedLoop;
}

std::filesystem::path robot_file(const std::string& name) {
  return name.empty() ? default_robot_file() : std::filesystem::path(name);
}

Parameters robot_in(const std::string& name) { return load_parameters(robot_file(name)); }

SimulatedRun simulated(const SimulateArguments& options) {
  SimulatedRun run{robot_in(options.robot), read_csv(options.trajectory), 0, {}, {}};
  if (const auto fault = malformed(run.trajectory)) throw InputError(options.trajectory, "", *fault);
  if (const auto fault = rows_missing(run.trajectory)) throw InputError(options.trajectory, "# rows", *fault);
  const PlannedWith header = planned_with(run.trajectory.metadata, options.trajectory);
  if (run.robot.payload == Payload{} && header.payload) run.robot.payload = *header.payload;
  Parameters arm = options.true_robot.empty() ? run.robot : robot_in(options.true_robot);
  tell_doubts(run.robot);
  const ControlMode control = control_named(options.control);
  if (control != ControlMode::kOpenLoop && stands(run.robot, run.trajectory, run.trajectory.samples.back()))
    run.hold = options.hold;
  run.simulation = simulate(run.robot, arm, run.trajectory, control, run.hold);
  run.figures = figures_of(arm, run.trajectory, run.simulation, exactness_tolerance(run.robot));
  return run;
}

// Visits name, joint, limit and what was reached of the robot's limits.
template <class Visit>
void visit_limits(const SimulatedRun& run, Visit&& visit) {
  const Limits limits = Limits::of(run.robot);
  for (const LimitName& name : kLimitNames) {
    if (std::isfinite(name.in(limits))) visit(*name.quantity, name.joint, name.in(limits), name.in(run.figures.peaks));
  }
}

SimulationJson simulation_json(const SimulateArguments& options, const SimulatedRun& run) {
  const RunFigures& figures = run.figures;
  SimulationJson json{{"trajectory", options.trajectory},
                      {"control", options.control},
                      {"completed", run.simulation.completed},
                      {"failure", run.simulation.failure},
                      {"duration", run.trajectory.end_time() - run.trajectory.start_time()},
                      {"link_error_rad", figures.link_error},
                      {"effort", figures.effort}};
  json["limits"] = SimulationJson::array();
  visit_limits(run, [&](const QuantityInfo& quantity, int joint, double limit, double reached) {
    json["limits"].push_back(
        {{"name", quantity.name}, {"joint", joint}, {"unit", quantity.unit}, {"limit", limit}, {"reached", reached}});
  });
  json["after_end"] = nullptr;
  if (run.hold > 0) {
    const double settling = figures.settling_time;
    json["after_end"] = {
        {"window", run.hold},
        {"residual_rad", figures.residual},
        {"settled_rad", exactness_tolerance(run.robot)},
        {"settling_time", std::isfinite(settling) ? SimulationJson(settling) : SimulationJson(nullptr)}};
  }
  return json;
}

std::string simulation_text(const SimulateArguments& options, const SimulatedRun& run) {
  const RunFigures& figures = run.figures;
  const double count = exactness_tolerance(run.robot);
  std::string text = fmt::format("{}: {}, {:.6g} s\n", options.trajectory, options.control,
                                 run.trajectory.end_time() - run.trajectory.start_time());
  if (!run.simulation.completed) text += fmt::format("  BROKE DOWN   {}\n", run.simulation.failure);
  text += fmt::format("  links        at most {:.3g} and {:.3g} rad off the trajectory ({:.3g} and {:.3g} counts)\n",
                      figures.link_error[0], figures.link_error[1], figures.link_error[0] / count,
                      figures.link_error[1] / count);
  if (run.hold > 0) {
    text +=
        fmt::format("  after it     at most {:.3g} and {:.3g} rad off the goal ({:.3g} and {:.3g} counts)\n",
                    figures.residual[0], figures.residual[1], figures.residual[0] / count, figures.residual[1] / count);
    text += std::isfinite(figures.settling_time)
                ? fmt::format("  settled      within one count {:.3f} s after the end\n", figures.settling_time)
                : fmt::format("  settled      NOT within one count in {:g} s after the end\n", run.hold);
  }
  text += fmt::format("  effort       {:.6g} N^2 m^2 s\n", figures.effort);
  visit_limits(run, [&](const QuantityInfo& quantity, int joint, double limit, double reached) {
    const double beyond = 100 * (reached / limit - 1);
    text += fmt::format("  reached      {} {} {:.5g} of {:.5g} {}{}\n", quantity.name, joint, reached, limit,
                        quantity.unit, beyond > 0.1 ? fmt::format(", {:.1f} % BEYOND", beyond) : "");
  });
  return text;
}

// Writes the motion of the arm, a row about every millisecond, under the header of a trajectory file.
void write_run(const SimulatedRun& run, const std::string& file) {
  Trajectory written;
  for (const Sample& sample : run.simulation.samples) {
    const bool last = &sample == &run.simulation.samples.back();
    if (last || written.samples.empty() || sample.time - written.samples.back().time >= kRowPeriod) {
      written.samples.push_back(sample);
    }
  }
  write_csv(written, file);
}

// Writes what the executor would have logged at every tick: encoder readings, and the torque that it then held.
void write_log(const SimulatedRun& run, const std::string& file) {
  Log log;
  const bool completed = run.simulation.completed;
  const ResultCode code = completed ? ResultCode::kSuccessful : ResultCode::kPathToleranceViolated;
  log.metadata = {{"robot_hash", robot_hash(run.robot)}, {"code", std::to_string(static_cast<std::int32_t>(code))}};
  if (!completed) log.metadata["sentence"] = run.simulation.failure;
  log.names = {"time"};
  for (const char* suffix : {"", "_plan"}) {
    for (const char* quantity : {"q", "theta", "tau"}) {
      for (int joint = 0; joint < kJoints; ++joint) log.names.push_back(joint_column(quantity, joint, suffix));
    }
  }
  log.values.resize(log.names.size());
  Interpolator plan(run.trajectory);
  const std::vector<Sample>& samples = run.simulation.samples;
  const double end = run.trajectory.end_time();
  for (std::size_t k = 0; k + 1 < samples.size() && samples[k].time < end; ++k) {
    const Sample planned = plan.at(samples[k].time);
    auto column = log.values.begin();
    column++->push_back(samples[k].time);
    const auto add = [&](const Joints<double>& of) {
      for (const double value : of) column++->push_back(value);
    };
    add({quantised(samples[k].state.q[0], run.robot.encoder.link_counts[0]),
         quantised(samples[k].state.q[1], run.robot.encoder.link_counts[1])});
    add({quantised(samples[k].state.theta[0], run.robot.encoder.motor_counts[0]),
         quantised(samples[k].state.theta[1], run.robot.encoder.motor_counts[1])});
    add(samples[k + 1].torque);
    add(planned.state.q);
    add(planned.state.theta);
    add(planned.torque);
  }
  write_file(file, format_log(log));
}

int run(const SimulateArguments& options) {
  if (!options.log.empty() && options.control != "executor") {
    throw InputError("--log", "", "'" + options.control + "' has no log: it is for --control executor");
  }
  if (!options.log.empty() &&
      std::filesystem::path(options.log).lexically_normal() == std::filesystem::path(options.out).lexically_normal()) {
    throw InputError("--log", "", options.log + " is the file of --out, too");
  }
  const std::vector<std::string> inputs{options.trajectory, robot_file(options.robot).string(), options.true_robot};
  refuse_to_overwrite("--out", options.out, inputs);
  refuse_to_overwrite("--log", options.log, inputs);
  refuse_another_kind("--out", options.out, ".csv");
  refuse_another_kind("--log", options.log, ".csv");
  const SimulatedRun run = simulated(options);
  if (!options.log.empty()) write_log(run, options.log);
  if (!options.out.empty()) write_run(run, options.out);
  fmt::print("{}", options.json ? json_text(simulation_json(options, run)) : simulation_text(options, run));
  return run.simulation.completed ? 0 : 1;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Run any trajectory file on the simulated arm: vibration, settling, limits reached");
  command->add_option("trajectory", options->trajectory, "Trajectory file, whoever made it")
      ->required()
      ->type_name("TRAJECTORY.csv");
  command
      ->add_option("--control", options->control,
                   "closed-loop: feedback on the exact state, as in the certificate; executor: encoder counts, 1 ms "
                   "ticks and the drives' peak torque; open-loop: the torques of the file alone")
      ->check(one_of({"closed-loop", "executor", "open-loop"}))
      ->capture_default_str();
  command
      ->add_option("--hold", options->hold,
                   "How long the arm is then held where the trajectory ends at rest, in seconds; not in open loop")
      ->check(between(0, kLongestHold))
      ->capture_default_str();
  command->add_option("--robot", options->robot, "Robot file that it is for; without it the one shipped with fjr")
      ->type_name("R");
  command->add_option("--true-robot", options->true_robot, "What the simulated arm really is: another robot file")
      ->type_name("R");
  command->add_option("--out", options->out, "File for what the arm did: rows about every millisecond")
      ->type_name("RUN.csv")
      ->check(file_to_write());
  command
      ->add_option("--log", options->log,
                   "File for what the executor would have logged of it; with --control executor. fjr learn takes it")
      ->type_name("LOG.csv")
      ->check(file_to_write());
  command->add_flag("--json", options->json, "Only JSON on stdout");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
