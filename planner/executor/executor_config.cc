#include "planner/executor/executor_config.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>

#include "common/strict_yaml.h"
#include "planner/protocol/bounded_name.h"

namespace fjr {
namespace {

void read_number(const YamlNode& root, std::string_view key, std::string_view unit, double most, double& to) {
  const auto node = root.find(key);
  if (!node) return;
  to = node->number(unit);
  if (!(to > 0) || to > most) {
    node->fail(fmt::format("{} is outside (0, {}]", with_unit(to, unit), with_unit(most, unit)));
  }
}

void read_pair(const YamlNode& root, std::string_view key, std::string_view unit, double least, double most,
               Joints<double>& to) {
  const auto node = root.find(key);
  if (!node) return;
  to = node->pair(unit);
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!(to[j] >= least && to[j] <= most)) {
      node->fail_at(j, fmt::format("{} is outside [{}, {}]", with_unit(to[j], unit), least, most));
    }
  }
}

void read_path(const YamlNode& root, std::string_view key, const std::filesystem::path& folder,
               std::filesystem::path& to) {
  if (const auto node = root.find(key)) to = folder / node->text();
}

void read_tolerances(const YamlNode& node, Tolerances& to) {
  node.allow_keys({"path", "goal", "goal_time", "stopped_velocity"});
  read_pair(node, "path", "rad", 1e-4, kWidestTolerance, to.path);
  read_pair(node, "goal", "rad", 1e-4, kWidestTolerance, to.goal);
  read_number(node, "goal_time", "s", kLongestGoalTime, to.goal_time);
  read_pair(node, "stopped_velocity", "rad/s", 1e-3, kWidestTolerance, to.stopped_velocity);
}

EncoderFault fault_from(const YamlNode& node) {
  node.allow_keys({"encoder", "above"});
  EncoderFault fault;
  fault.encoder = static_cast<EncoderFault::Encoder>(node.at("encoder").one_of({"q1", "q2", "theta1", "theta2"}));
  read_number(node, "above", "rad/s", 100, fault.above);
  return fault;
}

void read_arm(const YamlNode& node, const std::filesystem::path& folder, ExecutorConfig& to) {
  node.allow_keys({"start", "true_robot", "payload", "hysteresis", "encoder_fault"});
  read_pair(node, "start", "rad", -100, 100, to.start);
  read_path(node, "true_robot", folder, to.true_robot);
  read_number(node, "payload", "kg", 10, to.arm.payload);
  if (const auto hysteresis = node.find("hysteresis")) {
    hysteresis->allow_keys({"height", "width"});
    to.arm.hysteresis = Hysteresis{};
    read_pair(*hysteresis, "height", "N m", 0, 1, to.arm.hysteresis.height);
    read_pair(*hysteresis, "width", "rad", 1e-4, 1, to.arm.hysteresis.width);
  }
  if (const auto fault = node.find("encoder_fault")) to.arm.fault = fault_from(*fault);
}

std::filesystem::path folder_of(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

}  // namespace

ExecutorConfig default_executor_config() {
  ExecutorConfig config;
  config.robot = default_robot_file();
  return config;
}

ExecutorConfig load_executor_config(const std::filesystem::path& file) {
  ExecutorConfig config = default_executor_config();
  const std::filesystem::path folder = file.parent_path();
  const YamlNode root = YamlNode::load(file);
  root.allow_keys({"domain", "robot_id", "robot", "state", "logs", "priority", "oldest", "tolerances", "virtual_arm",
                   "security", "allow_insecure_network"});
  read_network(root, folder, config.network);
  if (const auto node = root.find("priority")) config.priority = static_cast<int>(node->whole_number(0, 99));
  read_number(root, "oldest", "s", 3600, config.oldest);
  read_path(root, "robot", folder, config.robot);
  read_path(root, "state", folder, config.state);
  read_path(root, "logs", folder, config.logs);
  read_name(root, "robot_id", config.robot_id);
  if (const auto node = root.find("tolerances")) read_tolerances(*node, config.tolerances);
  if (const auto node = root.find("virtual_arm")) read_arm(*node, folder, config);
  return config;
}

std::filesystem::path default_state_folder() {
  if (auto folder = folder_of("STATE_DIRECTORY"); !folder.empty()) return folder;
  if (auto folder = folder_of("XDG_STATE_HOME"); !folder.empty()) return folder / "fjr";
  if (auto folder = folder_of("HOME"); !folder.empty()) return folder / ".local" / "state" / "fjr";
  throw InputError("command line", "--state",
                   "is needed: none of STATE_DIRECTORY, XDG_STATE_HOME and HOME is set, and what was run must be "
                   "remembered");
}

}  // namespace fjr
