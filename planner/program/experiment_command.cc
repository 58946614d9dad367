// fjr experiment: the virtual rig performs the experiments of section IV.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "model/input_error.h"
#include "model/rig/experiments.h"
#include "planner/program/commands.h"
#include "planner/program/interrupt.h"
#include "planner/program/progress_line.h"
#include "planner/trajectory/atomic_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string name, out, robot;
  int joint = 0;  // 1 or 2; 0: not given
  bool ideal = false, slow = false;
  std::uint64_t seed = 1;
  std::vector<double> torque_noise, hysteresis, link_damping;  // two values each; empty: the rig's own
};

void override_with(Pair<double>& pair, const std::vector<double>& given) {
  if (!given.empty()) pair = {given[0], given[1]};
}

Rig rig_of(const Options& options) {
  const Parameters robot = load_parameters(options.robot.empty() ? default_robot_file() : fs::path(options.robot));
  Rig rig = options.ideal ? Rig::ideal(robot) : Rig::of(robot);
  rig.seed = options.seed;
  override_with(rig.instruments.torque_noise, options.torque_noise);
  override_with(rig.hysteresis.height, options.hysteresis);
  override_with(rig.truth.link.damping, options.link_damping);
  return rig;
}

void perform_one(const Options& options, const Rig& rig, const std::string& name, int joint, const fs::path& file) {
  ProgressLine line(fmt::format("{}, joint {}", name, joint));
  const Record record = perform(name, rig, joint - 1, options.ideal || options.slow, [&line](double fraction) {
    line.show(fraction);
    return !interrupted();
  });
  Log log = measure(record, rig);
  log.metadata["robot_hash"] = robot_hash(rig.truth);
  log.metadata["version"] = FJR_VERSION;
  write_file(file, format_log(log));
  fmt::print("{}: {} rows, {:.6g} s\n", file.string(), log.rows(), record.time.back());
}

void perform_all(const Options& options, const Rig& rig) {
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", options.out, error.message()));
  for (const char* name : kExperiments) {
    for (int joint = 1; joint <= kJoints; ++joint) {
      perform_one(options, rig, name, joint, fs::path(options.out) / fmt::format("{}_{}.csv", name, joint));
    }
  }
}

int run(const Options& options) {
  catch_interrupts();
  const Rig rig = rig_of(options);
  if (options.name == "all") {
    perform_all(options, rig);
  } else if (options.joint == 0) {
    throw InputError("--joint", "", "is needed for a single experiment: 1 or 2");
  } else {
    perform_one(options, rig, options.name, options.joint, options.out);
  }
  return 0;
}

}  // namespace

void add_experiment(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("experiment", "Perform an experiment on the virtual rig and write its log");
  std::vector<std::string> names(std::begin(kExperiments), std::end(kExperiments));
  names.emplace_back("all");
  command->add_option("name", options->name, "Which: stiffness, gravity, ..., or all for both joints")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_option("--joint", options->joint, "Joint")->check(CLI::Range(1, 2));
  command->add_option("--out", options->out, "The log; of all experiments the folder of <experiment>_<joint>.csv")
      ->required()
      ->type_name("LOG.csv|DIR");
  command->add_flag("--ideal", options->ideal, "Without noise, quantisation and hysteresis; slow speeds included");
  command->add_flag("--slow", options->slow, "Include the slow speeds of motor friction without --ideal");
  command->add_option("--seed", options->seed, "Seed of the noise")->capture_default_str();
  command->add_option("--robot", options->robot, "The true arm; without it the robot.yaml shipped with fjr");
  command->add_option("--torque-noise", options->torque_noise, "Standard deviations, N m")->expected(2);
  command->add_option("--hysteresis", options->hysteresis, "Half openings of the springs' loops, N m")->expected(2);
  command->add_option("--link-damping", options->link_damping, "True damping, N m s/rad")->expected(2);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
