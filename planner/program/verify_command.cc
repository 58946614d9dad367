// fjr verify: the certificate of any trajectory file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/certificate/certificate.h"
#include "planner/certificate/proof/prove.h"
#include "planner/certificate/residual.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/summary.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"

namespace fjr {
namespace {

struct VerifyArguments {
  std::string trajectory;
  std::string robot;            // empty: the default
  std::vector<double> payload;  // empty: the robot's own
  bool json = false;
  bool proven = false;
};

// The robot and the limits that the verdict is about: those given here, made no easier by anything in the file.
struct Conditions {
  Parameters robot;
  Limits limits;
  PlannedWith header;
  std::vector<std::string> contradictions;  // between the file and what was given, one sentence each
};

std::optional<Payload> payload_given(const VerifyArguments& options) {
  if (options.payload.empty()) return std::nullopt;
  return Payload{options.payload[0], options.payload.size() > 1 ? options.payload[1] : 0};
}

// --payload, or else the robot's, or else the file's.
void settle_payload(const VerifyArguments& options, Conditions& conditions) {
  const auto given = payload_given(options);
  if (given) conditions.robot.payload = *given;
  const auto& planned = conditions.header.payload;
  if (!planned || *planned == conditions.robot.payload) return;
  if (!given && conditions.robot.payload == Payload{}) {
    conditions.robot.payload = *planned;
  } else {
    conditions.contradictions.push_back(fmt::format("payload: it was planned with {}, but {} {}", text_of(*planned),
                                                    given ? "--payload says" : "the robot has",
                                                    text_of(conditions.robot.payload)));
  }
}

void tighten(Conditions& conditions) {
  for (const LimitInHeader& header : conditions.header.limits) {
    double& limit = *limit_of(conditions.limits, header.name, header.joint);
    if (header.value > limit) {
      conditions.contradictions.push_back(fmt::format("{}: the file says {} {}, but the robot's {} {} hold", header.key,
                                                      header.value, header.unit, limit, header.unit));
    }
    limit = std::min(limit, header.value);
  }
}

// Of a robot that differs in more than the payload.
void compare_robots(const Trajectory& trajectory, Conditions& conditions) {
  const auto planned_for = trajectory.metadata.find("robot_hash");
  const std::string hash = robot_hash(conditions.robot);
  if (planned_for == trajectory.metadata.end() || planned_for->second == hash) return;
  Parameters as_planned = conditions.robot;
  if (conditions.header.payload) as_planned.payload = *conditions.header.payload;
  if (robot_hash(as_planned) == planned_for->second) return;
  conditions.contradictions.push_back(
      fmt::format("it was planned for another robot (robot_hash {}, this robot's is {}){}", planned_for->second, hash,
                  conditions.header.payload ? "" : " or payload"));
}

Conditions conditions_of(const VerifyArguments& options, const Trajectory& trajectory) {
  Conditions conditions;
  conditions.robot =
      load_parameters(options.robot.empty() ? default_robot_file() : std::filesystem::path(options.robot));
  conditions.header = planned_with(trajectory.metadata, options.trajectory);
  settle_payload(options, conditions);
  conditions.limits = Limits::of(conditions.robot);
  tighten(conditions);
  compare_robots(trajectory, conditions);
  return conditions;
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
  const State<double>& x = row.state;
  constexpr double kStill = 1e-9;  // [rad/s] what rounding leaves of a plan's rest
  const auto fastest = std::max({std::abs(x.dq[0]), std::abs(x.dq[1]), std::abs(x.dtheta[0]), std::abs(x.dtheta[1])});
  if (fastest > kStill) {
    return fmt::format("{} MOVING, links at {:.4g} and {:.4g} rad/s, motors at {:.4g} and {:.4g} rad/s", verb, x.dq[0],
                       x.dq[1], x.dtheta[0], x.dtheta[1]);
  }
  const Joints<double> balanced = rest_at(robot, x.q).theta;
  return fmt::format("{} OUT OF BALANCE, motors {:.4g} and {:.4g} rad off where the springs hold the links", verb,
                     x.theta[0] - balanced[0], x.theta[1] - balanced[1]);
}

std::string header_text(const Conditions& conditions) {
  std::string text;
  if (conditions.robot.payload != Payload{}) text = "payload " + text_of(conditions.robot.payload);
  for (const LimitInHeader& limit : conditions.header.limits) text += (text.empty() ? "" : ", ") + limit.text();
  return text.empty() ? "" : fmt::format("  {:<11} {}\n", "with", text);
}

std::string text_for_people(const VerifyArguments& options, const Conditions& conditions, const Trajectory& trajectory,
                            const Certificate& certificate) {
  const Parameters& robot = conditions.robot;
  return fmt::format(
      "{}: {} against the robot's limits{} ({} rows{}, {:.6g} s, {}, {})\n{}{}", options.trajectory,
      certificate.certified ? "certified" : "certificate failed",
      conditions.header.limits.empty() ? "" : " and the request's", trajectory.samples.size(),
      is_complete(trajectory) ? "" : "; how many there were is not said, so some may be missing",
      trajectory.end_time() - trajectory.start_time(), motion_of("starts", robot, trajectory.samples.front()),
      motion_of("ends", robot, trajectory.samples.back()), header_text(conditions), summary(certificate));
}

std::string text_for_machines(const Conditions& conditions, const Trajectory& trajectory,
                              const Certificate& certificate) {
  const Parameters& robot = conditions.robot;
  nlohmann::ordered_json json = certificate_json(certificate);
  const std::optional<bool> complete = is_complete(trajectory);
  json["complete"] = complete ? nlohmann::ordered_json(*complete) : nlohmann::ordered_json(nullptr);
  json["starts_at_rest"] = is_at_rest(robot, trajectory.samples.front());
  json["ends_at_rest"] = is_at_rest(robot, trajectory.samples.back());
  json["robot_hash"] = robot_hash(robot);
  json["payload"] = {{"mass", robot.payload.mass}, {"inertia", robot.payload.inertia}};
  json["contradictions"] = conditions.contradictions;
  return json_text(json);
}

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& task) {
  for_each_index(count, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())), task);
}

int run(const VerifyArguments& options) {
  const Trajectory trajectory = read_csv(options.trajectory);
  const Conditions conditions = conditions_of(options, trajectory);
  tell_doubts(conditions.robot);
  for (const std::string& contradiction : conditions.contradictions) {
    fmt::print(stderr, "fjr: warning: {}: {}\n", options.trajectory, contradiction);
  }
  Certificate certificate = certify(conditions.robot, conditions.limits, trajectory);
  if (options.proven) {
    demand_proof(conditions.robot, conditions.limits, trajectory, certificate, on_all_cores);
  }
  check_completeness(trajectory, certificate);
  if (!certificate.certified) {  // the reason behind the others
    certificate.failures.insert(certificate.failures.begin(), conditions.contradictions.begin(),
                                conditions.contradictions.end());
  }
  fmt::print("{}", options.json ? text_for_machines(conditions, trajectory, certificate)
                                : text_for_people(options, conditions, trajectory, certificate));
  return exit_code(certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified);
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "Certify a trajectory file: exactness and the robot's limits");
  command->add_option("trajectory", options->trajectory, "Trajectory file")->required()->type_name("TRAJECTORY.csv");
  command->add_option("--robot", options->robot, "Robot file; without it the one shipped with fjr")->type_name("R");
  command
      ->add_option("--payload", options->payload,
                   "Mass at the tip, and inertia about its own centre; without it what the robot or the file's header "
                   "says")
      ->expected(1, 2)
      ->check(CLI::NonNegativeNumber)
      ->type_name("KG [KG M^2]");
  command->add_flag("--proven", options->proven,
                    "Bounds that hold with mathematical certainty too: certified only if everything is proven");
  command->add_flag("--json", options->json, "Only JSON on stdout: the certificate");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
