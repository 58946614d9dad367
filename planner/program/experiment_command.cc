// fjr experiment: the virtual rig performs the experiments of section IV; or an experiment of another kind is designed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/atomic_file.h"
#include "common/input_error.h"
#include "common/say.h"
#include "model/rig/experiments.h"
#include "model/rig/rig_file.h"
#include "planner/design/experiment_design.h"
#include "planner/plan.h"
#include "planner/program/commands.h"
#include "planner/program/experiment_design.h"
#include "planner/program/file_checks.h"
#include "planner/program/interrupt.h"
#include "planner/program/misspelt.h"
#include "planner/program/number_checks.h"
#include "planner/program/progress_line.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct ExperimentArguments {
  std::string name, out, robot, rig;
  int joint = 0;  // 1 or 2; 0: not given
  bool ideal = false, slow = false;
  std::optional<std::uint64_t> seed;
  std::vector<double> torque_noise, hysteresis, link_damping;  // two values each; empty: the rig's own
};

void override_with(Joints<double>& pair, const std::string& option, const std::vector<double>& given) {
  if (given.empty()) return;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const bool allowed = given[j] >= 0 && std::isfinite(given[j]);
    if (!allowed) throw InputError(option, "", fmt::format("{} is not a number from 0 up", given[j]));
    pair[j] = given[j];
  }
}

// The more specific source takes precedence: options, then rig.yaml, then --ideal.
RigSetup setup_of(const ExperimentArguments& options) {
  const Parameters robot = load_bare_parameters(options.robot.empty() ? default_robot_file() : fs::path(options.robot));
  RigSetup setup{options.ideal ? Rig::ideal(robot) : Rig::of(robot),
                 Experiments::of_paper(options.ideal || options.slow)};
  if (!options.rig.empty()) read_rig(options.rig, setup);
  Rig& rig = setup.rig;
  rig.seed = options.seed.value_or(rig.seed);
  override_with(rig.instruments.torque_noise, "--torque-noise", options.torque_noise);
  override_with(rig.hysteresis.height, "--hysteresis", options.hysteresis);
  override_with(rig.truth.link.damping, "--link-damping", options.link_damping);
  return setup;
}

void perform_one(const RigSetup& setup, const std::string& name, int joint, const fs::path& file) {
  const Rig& rig = setup.rig;
  ProgressLine line(fmt::format("{}, joint {}", name, joint));
  const Record record = perform(name, rig, joint - 1, setup.experiments, [&line](double fraction) {
    line.show(fraction);
    return !interrupted();
  });
  Log log = measure(record, rig);
  log.metadata["robot_hash"] = robot_hash(rig.truth);
  log.metadata["version"] = FJR_VERSION;
  write_file(file, format_log(log));
  say_in(stdout, "{}: {} rows, {:.6g} s\n", file.string(), log.rows(), record.time.back());
}

// Returns whether a log is of the virtual rig, which alone has a seed. A real rig's logs have the same names and must
// not be overwritten, because they cannot be recorded again.
bool is_of_the_virtual_rig(const fs::path& file) {
  std::ifstream log(file);
  if (!log) throw InputError("--out", "", fmt::format("{} is there, and cannot be read", file.string()));
  for (std::string line; std::getline(log, line) && line.starts_with("#");) {
    if (line.starts_with("# seed:")) return true;
  }
  return false;
}

void check_log_to_write(const fs::path& file) {
  if (const std::string fault = fault_of_file_to_write(file.string()); !fault.empty()) {
    throw InputError("--out", "", fault);
  }
  std::error_code ignored;
  if (!fs::exists(file, ignored) || is_of_the_virtual_rig(file)) return;
  throw InputError("--out", "",
                   fmt::format("{} is no log of the virtual rig, and would be lost; give another name", file.string()));
}

void perform_all(const ExperimentArguments& options, const RigSetup& setup) {
  const auto log_of = [&](const std::string& name, int joint) {
    return fs::path(options.out) / fmt::format("{}_{}.csv", name, joint);
  };
  const auto each = [](const auto& visit) {
    for (const std::string& name : experiment_names()) {
      for (int joint = 1; joint <= kJoints; ++joint) visit(name, joint);
    }
  };
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", options.out, error.message()));
  each([&](const std::string& name, int joint) { check_log_to_write(log_of(name, joint)); });
  each([&](const std::string& name, int joint) { perform_one(setup, name, joint, log_of(name, joint)); });
}

int run(const ExperimentArguments& options) {
  if (options.name.empty()) throw InputError("command line", "", "an experiment is needed, or `design` (see --help)");
  if (options.out.empty()) throw InputError("--out", "", "is needed: the log; of all experiments a folder");
  if (options.name == "all" && options.joint != 0) {
    throw InputError("--joint", "", "is for a single experiment; all are of both joints");
  }
  if (options.name != "all") check_log_to_write(options.out);
  if (options.name != "all" && options.joint == 0) {
    throw InputError("--joint", "", "is needed for a single experiment: 1 or 2");
  }
  catch_interrupts();
  const RigSetup setup = setup_of(options);
  try {
    if (options.name == "all") {
      perform_all(options, setup);
    } else {
      perform_one(setup, options.name, options.joint, options.out);
    }
  } catch (const std::runtime_error&) {
    if (!interrupted()) throw;
    say("fjr: experiment: cancelled; the log that it was at was not written\n");
    return exit_code(PlanStatus::kCancelled);
  }
  return 0;
}

void add_design(CLI::App& experiment, int& exit_code) {
  const auto options = std::make_shared<ExperimentDesignArguments>();
  CLI::App* command = experiment.add_subcommand(
      "design", "Plan motions that tell the arm's parameters best: requests for the service, one after the other");
  command->add_option("--out", options->out, "Folder of 01.yaml, 02.yaml, ... and design.json; empty or not there")
      ->required()
      ->type_name("DIR");
  command->add_option("--robot", options->robot,
                      "What is known of the arm; without it the robot.yaml shipped with fjr");
  command->add_option("--start", options->start, "Link angles where the arm rests before the first of them, rad; 0 0")
      ->check(finite())
      ->expected(2)
      ->type_name("Q1 Q2");
  command->add_option("--duration", options->duration, "Of all motions together at most, s")
      ->check(between(1, kLongestDesign))
      ->capture_default_str();
  command->add_option("--candidates", options->candidates, "Planned for each motion, of which the best is taken")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the candidates")->check(seed())->capture_default_str();
  command
      ->add_option("--widen", options->widen, "Take the standard errors of the robot file for so many times as large")
      ->check(between(1, 1000))
      ->type_name("TIMES");
  command->add_flag("--payload-known", options->payload_known,
                    "The mass at the tip is as in the robot file; otherwise it is taken for unknown within 0.5 kg");
  command->add_flag("--json", options->json, "Only JSON on stdout");
  command->callback([options, &exit_code] { exit_code = experiment_design(*options); });
}

}  // namespace

void add_experiment(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ExperimentArguments>();
  CLI::App* command = app.add_subcommand(
      "experiment", "Perform an experiment on the virtual rig and write its log; or design one for the real arm");
  add_design(*command, exit_code);
  std::vector<std::string> names = experiment_names();
  names.emplace_back("all");
  command->add_option("name", options->name, "Which: stiffness, gravity, ..., or all for both joints")
      ->check(one_of(names));
  command->add_option("--joint", options->joint, "Joint")->check(CLI::Range(1, 2));
  command->add_option("--out", options->out, "The log; of all experiments the folder of <experiment>_<joint>.csv")
      ->type_name("LOG.csv|DIR");
  command->add_flag("--ideal", options->ideal, "Without noise, quantisation and hysteresis; slow speeds included");
  command->add_flag("--slow", options->slow, "Include the slow speeds of motor friction without --ideal");
  command->add_option("--seed", options->seed, "Seed of the noise; 1 without it")->check(seed());
  command->add_option("--robot", options->robot, "The true arm; without it the robot.yaml shipped with fjr");
  command
      ->add_option("--rig", options->rig,
                   "Instruments, hysteresis, gravity, rates, steps, speeds, ...: as in config/rig.yaml")
      ->type_name("rig.yaml");
  command->add_option("--torque-noise", options->torque_noise, "Standard deviations, N m")->expected(2);
  command->add_option("--hysteresis", options->hysteresis, "Half openings of the springs' loops, N m")->expected(2);
  command->add_option("--link-damping", options->link_damping, "True damping, N m s/rad")->expected(2);
  command->callback([options, command, &exit_code] {
    if (!command->got_subcommand("design")) exit_code = run(*options);
  });
}

}  // namespace fjr
