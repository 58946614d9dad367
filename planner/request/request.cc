#include "planner/request/request.h"

#include <fmt/format.h>

#include <initializer_list>
#include <utility>

#include "planner/request/place.h"
#include "planner/request/request_keys.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

Parameters robot_of(const Request& request, const fs::path& folder, const fs::path& default_robot) {
  return load_parameters(robot_file_of(request, folder, default_robot));
}

}  // namespace

GoalByKey by_key(const RequestedGoal& goal) {
  GoalByKey keys;
  if (const auto* tip = std::get_if<TipGoal>(&goal)) {
    keys.tip = tip->tip;
    if (tip->elbow != Elbow::kAny) keys.elbow = tip->elbow;
    keys.tip_velocity = tip->velocity;
    return keys;
  }
  const auto& [q, arrival] = std::get<JointGoal>(goal);
  keys.q = q;
  if (std::holds_alternative<AnyVelocity>(arrival)) keys.dq = AnyVelocity{};
  if (const auto* moving = std::get_if<Moving>(&arrival)) {
    keys.dq = moving->dq;
    keys.theta = moving->theta;
    keys.dtheta = moving->dtheta;
  }
  return keys;
}

std::optional<KeyFault> fault_of(const GoalByKey& goal) {
  const auto first_of = [](std::initializer_list<std::pair<std::string_view, bool>> keys, const char* sentence) {
    for (const auto& [key, given] : keys) {
      if (given) return std::optional(KeyFault{key, sentence});
    }
    return std::optional<KeyFault>{};
  };
  const std::pair<std::string_view, bool> theta{"theta", goal.theta.has_value()},
      dtheta{"dtheta", goal.dtheta.has_value()};
  if (goal.tip) {
    return first_of({{"q", goal.q.has_value()}, {"dq", goal.dq.has_value()}, theta, dtheta},
                    "does not go with goal.tip, which decides it");
  }
  if (goal.elbow) {
    const bool decided = goal.q && (*goal.q)[1];
    return KeyFault{"elbow",
                    decided ? "goes with goal.tip: goal.q has its elbow on one side already" : "goes with goal.tip"};
  }
  if (goal.tip_velocity) return KeyFault{"tip_velocity", "goes with goal.tip; with goal.q give dq"};
  if (!goal.q) return KeyFault{"q", "missing"};
  if (!goal.dq) {
    return first_of({theta, dtheta},
                    "needs goal.dq beside it; without goal.dq the arm ends at rest and the motors with it");
  }
  if (!std::holds_alternative<AnyVelocity>(*goal.dq)) return std::nullopt;
  return first_of({theta, dtheta}, "does not go with goal.dq: free, which leaves the motors free");
}

RequestedGoal goal_of(const GoalByKey& goal) {
  if (goal.tip) return TipGoal{*goal.tip, goal.elbow.value_or(Elbow::kAny), goal.tip_velocity};
  JointGoal joints{goal.q.value_or(AnglesOrFree{}), AtRest{}};
  if (!goal.dq) return joints;
  const auto* dq = std::get_if<Joints<double>>(&*goal.dq);
  joints.arrival = dq != nullptr ? Arrival{Moving{*dq, goal.theta, goal.dtheta}} : Arrival{AnyVelocity{}};
  return joints;
}

TipByKind by_kind(const RequestedTip& tip) {
  TipByKind kinds;
  visit(kinds, [&](const Key&, auto& kind) {
    using Region = typename std::decay_t<decltype(kind)>::value_type;
    if (const Region* region = std::get_if<Region>(&tip)) kind = *region;
  });
  return kinds;
}

fs::path robot_file_of(const Request& request, const fs::path& folder, const fs::path& default_robot) {
  if (!request.robot) return default_robot.empty() ? default_robot_file() : default_robot;
  const fs::path file = folder / *request.robot;  // an absolute path stays as it is
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    const char* const what = fs::exists(file, error) ? "not a file" : "no such file";
    Place{request, "robot"}.fail(fmt::format("{}: {}", what, shown(file.string())));
  }
  return file;
}

Problem load_request(const fs::path& file, const fs::path& default_robot) {
  const Request request = read_request(YamlNode::load(file));
  return resolve(request, robot_of(request, file.parent_path(), default_robot));
}

Problem parse_request(const std::string& yaml, const std::string& source, const fs::path& folder,
                      const fs::path& default_robot) {
  const Request request = read_request(YamlNode::parse(yaml, source));
  return resolve(request, robot_of(request, folder, default_robot));
}

Problem parse_request(const std::string& yaml, const std::string& source, const Parameters& robot) {
  return resolve_for(read_request(YamlNode::parse(yaml, source)), robot);
}

Problem resolve_for(const Request& request, const Parameters& robot) {
  if (request.robot) Place{request, "robot"}.fail("the robot is given already");
  return resolve(request, robot);
}

}  // namespace fjr
