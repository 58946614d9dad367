// fjr verify: the certificate of any trajectory file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/say.h"
#include "planner/certificate/certificate.h"
#include "planner/certificate/residual.h"
#include "planner/certificate/robust/robustness.h"
#include "planner/program/commands.h"
#include "planner/program/doubts.h"
#include "planner/program/number_checks.h"
#include "planner/program/request_file.h"
#include "planner/program/summary.h"
#include "planner/results/plan_json.h"
#include "planner/results/planned_with.h"
#include "planner/results/verification.h"

namespace fjr {
namespace {

struct VerifyArguments {
  std::string trajectory;
  std::string robot;            // empty: the default
  std::vector<double> payload;  // empty: the robot's own
  std::string request;          // empty: only what the folder of a plan says of it
  bool json = false;
  bool proven = false;
  double robust = 0;  // 0: not asked for
};

struct OptionPlace {
  [[noreturn]] void fail(const std::string& sentence) const { throw InputError("--payload", "", sentence); }
};

std::optional<Payload> payload_given(const VerifyArguments& options) {
  if (options.payload.empty()) return std::nullopt;
  const Payload payload{options.payload[0], options.payload.size() > 1 ? options.payload[1] : 0};
  const OptionPlace place;
  kPayloadMassBound.check(place, payload.mass);
  kPayloadInertiaBound.check(place, payload.inertia);
  return payload;
}

// Describes whether the arm rests at one end of the trajectory, which an executor requires at both.
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

std::string header_text(const Verification& v) {
  std::string text;
  if (v.robot.payload != Payload{}) text = "payload " + text_of(v.robot.payload);
  for (LimitInHeader limit : v.header.limits) {
    limit.value = kLimitNames[limit.index].in(v.limits);  // the robot's, where the file's would be looser
    text += (text.empty() ? "" : ", ") + limit.text();
  }
  return text.empty() ? "" : fmt::format("  {:<11} {}\n", "with", text);
}

std::string text_for_people(const VerifyArguments& options, const Trajectory& trajectory, const Verification& v) {
  return fmt::format(
      "{}: {} against the robot's limits{}{} ({} rows{}, {:.6g} s, {}, {})\n{}{}", options.trajectory,
      v.certificate.certified ? "certified" : "certificate failed", v.header.limits.empty() ? "" : " and the request's",
      options.request.empty() ? v.certificate.task.empty() ? "" : " and the plan's task"
                              : fmt::format(", and as {} asks", source_of(options.request).string()),
      trajectory.samples.size(), v.complete ? "" : "; how many there were is not said, so some may be missing",
      trajectory.end_time() - trajectory.start_time(), motion_of("starts", v.robot, trajectory.samples.front()),
      motion_of("ends", v.robot, trajectory.samples.back()), header_text(v), summary(v.certificate, v.limits));
}

// What a trajectory is held against.
struct Demands {
  Parameters robot;
  VerifyOptions options;
};

Demands demands(const VerifyArguments& options, const Trajectory& trajectory) {
  PlannedMotion of_plan;
  if (std::filesystem::is_directory(options.trajectory)) of_plan = planned_motion(options.trajectory);
  Demands on;
  if (options.request.empty()) {
    on.robot = load_parameters(options.robot.empty() ? default_robot_file() : std::filesystem::path(options.robot));
    on.options.payload = payload_given(options);
    on.options.planned = std::move(of_plan);
  } else {
    const Problem request = resolve_named(read_named(options.request), options.robot).problem;
    on = {request.robot, as_asked_by(request, std::move(of_plan), trajectory)};
  }
  on.options.proven = on.options.proven || options.proven;
  if (options.robust > 0) on.options.robust = options.robust;
  return on;
}

std::filesystem::path rows_of(const std::string& given) {
  const std::filesystem::path path = given;
  return std::filesystem::is_directory(path) ? path / "trajectory.csv" : path;
}

int run(const VerifyArguments& options) {
  const Trajectory trajectory = read_csv(rows_of(options.trajectory));
  const Demands on = demands(options, trajectory);
  const Verification v = verify(trajectory, options.trajectory, on.robot, on.options);
  tell_doubts(v.robot);
  for (const std::string& contradiction : v.contradictions) {
    say("fjr: warning: {}: {}\n", options.trajectory, contradiction);
  }
  fmt::print("{}",
             options.json ? json_text(verification_json(trajectory, v)) : text_for_people(options, trajectory, v));
  return exit_code(v.certificate.certified ? PlanStatus::kCertified : PlanStatus::kUncertified);
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "Certify a trajectory file: exactness and the robot's limits");
  command->add_option("trajectory", options->trajectory, "Trajectory file, or the folder of a plan")
      ->required()
      ->type_name("TRAJECTORY.csv");
  command
      ->add_option(
          "--request", options->request,
          "Request file, or - for standard input: certified only if this is what the trajectory does, whatever "
          "plan.json says")
      ->type_name("REQUEST.yaml");
  command->add_option("--robot", options->robot, "Robot file; without it the request's, or the one shipped with fjr")
      ->type_name("R");
  command
      ->add_option("--payload", options->payload,
                   "Mass at the tip, and inertia about its own centre; without it what the robot or the file's header "
                   "says")
      ->expected(1, 2)
      ->check(not_negative())
      ->type_name("KG [KG M^2]")
      ->excludes("--request");
  command->add_flag("--proven", options->proven,
                    "Bounds that hold with mathematical certainty too: certified only if everything is proven");
  command
      ->add_option("--robust", options->robust,
                   "Margins for the arms that the robot's uncertainty leaves possible: certified only if this fraction "
                   "of them keeps everything, with the executor's feedback")
      ->check(between(kLeastConfidence, kMostConfidence))
      ->type_name("P");
  command->add_flag("--json", options->json, "Only JSON on stdout: the certificate");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace fjr
