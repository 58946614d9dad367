// fjr verify: the certificate of any trajectory file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "planner/certificate/certificate.h"
#include "planner/program/commands.h"
#include "planner/program/summary.h"
#include "planner/trajectory/plan_json.h"

namespace fjr {
namespace {

struct VerifyArguments {
  std::string trajectory;
  std::string robot;            // empty: the default
  std::vector<double> payload;  // empty: the robot's own
  bool json = false;
};

// The verdict is about the robot given here; that the file was made for another one is worth knowing.
void warn_of_other_robot(const VerifyArguments& options, const Trajectory& trajectory, const std::string& hash) {
  const auto planned_for = trajectory.metadata.find("robot_hash");
  if (planned_for == trajectory.metadata.end() || planned_for->second == hash) return;
  fmt::print(stderr, "fjr: warning: {} was planned for another robot (robot_hash {}, this robot's is {}) or payload\n",
             options.trajectory, planned_for->second, hash);
}

// A file that was cut short is as exact as before, but not what was planned.
void check_completeness(const Trajectory& trajectory, Certificate& certificate) {
  const auto rows = trajectory.metadata.find("rows");
  if (rows == trajectory.metadata.end() || rows->second == std::to_string(trajectory.samples.size())) return;
  certificate.certified = false;
  certificate.failures.push_back(
      fmt::format("the file has {} rows, but says that it had {}", trajectory.samples.size(), rows->second));
}

std::string end_of(const Trajectory& trajectory, const Certificate& certificate) {
  if (certificate.residual.evaluated) return "ends at rest";
  const Pair<double>& dq = trajectory.samples.back().state.dq;
  return fmt::format("ends MOVING, links at {:.4g} and {:.4g} rad/s", dq[0], dq[1]);
}

std::string text_for_people(const VerifyArguments& options, const Trajectory& trajectory,
                            const Certificate& certificate) {
  return fmt::format("{}: {} against the robot's limits ({} rows, {:.6g} s, {})\n{}", options.trajectory,
                     certificate.certified ? "certified" : "certificate failed", trajectory.samples.size(),
                     trajectory.end_time() - trajectory.start_time(), end_of(trajectory, certificate),
                     summary(certificate));
}

std::string text_for_machines(const Certificate& certificate, const std::string& hash) {
  nlohmann::ordered_json json = certificate_json(certificate);
  json["robot_hash"] = hash;
  return json_text(json);
}

int run(const VerifyArguments& options) {
  Parameters robot =
      load_parameters(options.robot.empty() ? default_robot_file() : std::filesystem::path(options.robot));
  if (!options.payload.empty())
    robot.payload = {options.payload[0], options.payload.size() > 1 ? options.payload[1] : 0};
  const Trajectory trajectory = read_csv(options.trajectory);
  const std::string hash = robot_hash(robot);
  warn_of_other_robot(options, trajectory, hash);
  Certificate certificate = certify(robot, Limits::of(robot), trajectory);
  check_completeness(trajectory, certificate);
  fmt::print("{}",
             options.json ? text_for_machines(certificate, hash) : text_for_people(options, trajectory, certificate));
  return exit_code(certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified);
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "Certify a trajectory file: exactness and the robot's limits");
  command->add_option("trajectory", options->trajectory, "Trajectory file")->required()->type_name("TRAJECTORY.csv");
  command->add_option("--robot", options->robot, "Robot file; without it the one shipped with fjr")->type_name("R");
  command->add_option("--payload", options->payload, "What it was planned with: mass, and inertia about its own centre")
      ->expected(1, 2)
      ->check(CLI::NonNegativeNumber)
      ->type_name("KG [KG M^2]");
  command->add_flag("--json", options->json, "Only JSON on stdout: the certificate");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
