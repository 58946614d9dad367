// fjr verify: the certificate of any trajectory file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "planner/certificate/certificate.h"
#include "planner/certificate/residual.h"
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

// Whether all rows are there that the file says that it had; nothing where it does not say.
std::optional<bool> is_complete(const Trajectory& trajectory) {
  const auto rows = trajectory.metadata.find("rows");
  if (rows == trajectory.metadata.end()) return std::nullopt;
  return rows->second == std::to_string(trajectory.samples.size());
}

// A file that was cut short is as exact as before, but not what was planned.
void check_completeness(const Trajectory& trajectory, Certificate& certificate) {
  if (is_complete(trajectory).value_or(true)) return;
  certificate.certified = false;
  certificate.failures.push_back(fmt::format("the file has {} rows, but says that it had {}", trajectory.samples.size(),
                                             trajectory.metadata.at("rows")));
}

// What an executor asks for first: that the arm rests at either end.
std::string motion_of(const char* verb, const Parameters& robot, const Sample& row) {
  if (is_at_rest(robot, row)) return fmt::format("{} at rest", verb);
  const Pair<double>& dq = row.state.dq;
  return fmt::format("{} MOVING, links at {:.4g} and {:.4g} rad/s", verb, dq[0], dq[1]);
}

std::string text_for_people(const VerifyArguments& options, const Parameters& robot, const Trajectory& trajectory,
                            const Certificate& certificate) {
  return fmt::format("{}: {} against the robot's limits ({} rows{}, {:.6g} s, {}, {})\n{}", options.trajectory,
                     certificate.certified ? "certified" : "certificate failed", trajectory.samples.size(),
                     is_complete(trajectory) ? "" : "; how many there were is not said, so some may be missing",
                     trajectory.end_time() - trajectory.start_time(),
                     motion_of("starts", robot, trajectory.samples.front()),
                     motion_of("ends", robot, trajectory.samples.back()), summary(certificate));
}

std::string text_for_machines(const Parameters& robot, const Trajectory& trajectory, const Certificate& certificate,
                              const std::string& hash) {
  nlohmann::ordered_json json = certificate_json(certificate);
  const std::optional<bool> complete = is_complete(trajectory);
  json["complete"] = complete ? nlohmann::ordered_json(*complete) : nlohmann::ordered_json(nullptr);
  json["starts_at_rest"] = is_at_rest(robot, trajectory.samples.front());
  json["ends_at_rest"] = is_at_rest(robot, trajectory.samples.back());
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
  fmt::print("{}", options.json ? text_for_machines(robot, trajectory, certificate, hash)
                                : text_for_people(options, robot, trajectory, certificate));
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
