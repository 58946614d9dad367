#include "planner/service/service_config.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "common/host_name.h"
#include "common/strict_yaml.h"
#include "model/parameters.h"
#include "planner/protocol/bounded_name.h"
#include "planner/protocol/messages.h"

namespace fjr {
namespace {

std::string this_process() {
  constexpr std::size_t kOfHost = 47;  // characters, which leave room for a number and a robot
  return fmt::format("{}-{}", host_name().substr(0, kOfHost), ::getpid());
}

template <class Whole>
void read_whole(const YamlNode& root, std::string_view key, std::uint64_t least, std::uint64_t most, Whole& to) {
  if (const auto node = root.find(key)) to = static_cast<Whole>(node->whole_number(least, most));
}

void read_seconds(const YamlNode& root, std::string_view key, double& to) {
  const auto node = root.find(key);
  if (!node) return;
  to = node->number("s");
  if (!(to > 0) || to > 86400) node->fail(fmt::format("{} s is outside (0, 86400]", to));
}

void read_ros2(const YamlNode& node, ServiceConfig& config) {
  node.allow_keys({"joint_trajectory", "joint_names"});
  if (const auto on = node.find("joint_trajectory")) config.joint_trajectory = on->truth();
  const auto names = node.find("joint_names");
  if (!names) return;
  const std::vector<YamlNode> items = names->items();
  if (items.size() != kJoints) names->fail(fmt::format("{} names, there are {} joints", items.size(), kJoints));
  for (std::size_t j = 0; j < kJoints; ++j) config.joint_names[j] = items[j].text();
  if (config.joint_names[0] == config.joint_names[1]) names->fail("the two names are the same");
}

// Returns the instance name of one of several services in a process.
std::string instance_of(const ServiceConfig& config, const std::string& robot_id) {
  return config.instance + "/" + robot_id;
}

void read_robots(const YamlNode& root, const std::filesystem::path& folder, ServiceConfig& config) {
  const auto list = root.find("robots");
  if (!list) return;
  for (const char* key : {"robot_id", "robot"}) {
    if (const auto node = root.find(key)) node->fail("stands beside `robots`, which names id and file of each robot");
  }
  for (const YamlNode& item : list->items()) {
    item.allow_keys({"id", "robot"});
    ServedRobot& robot = config.robots.emplace_back();
    (void)item.at("id");
    read_name(item, "id", robot.id);
    const auto same = [&](const ServedRobot& other) { return other.id == robot.id; };
    if (std::ranges::count_if(config.robots, same) > 1) item.at("id").fail("the same as of a robot before it");
    if (const std::size_t length = instance_of(config, robot.id).size(); length > kLongestName) {
      item.at("id").fail(
          fmt::format("with the instance's name {} characters, above the {} allowed", length, kLongestName));
    }
    const auto file = item.find("robot");
    robot.file = file ? folder / file->text() : default_robot_file();
  }
  if (config.robots.empty()) list->fail("an empty list: name at least one robot, or leave it out");
  if (config.robots.size() > 1 && config.joint_trajectory) {
    root.at("ros2").at("joint_trajectory").fail("true, but the topic is one robot's alone, and `robots` has several");
  }
}

void read_metrics(const YamlNode& node, ServiceConfig& config) {
  node.allow_keys({"port"});
  config.metrics_port = 9464;  // what OpenTelemetry's exporters use
  read_whole(node, "port", 0, 65535, *config.metrics_port);
}

// Returns the folder that a key names, relative to the configuration file. It need not be there yet.
std::filesystem::path folder_named(const YamlNode& node, const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path() / node.text();
  std::error_code ignored;
  const bool other = std::filesystem::exists(folder, ignored) && !std::filesystem::is_directory(folder, ignored);
  if (other) node.fail(fmt::format("{} is a file, not a folder", folder.string()));
  return folder;
}

// A request that names no budget gets the default one, which may not be above what a request may ask for.
void read_budgets(const YamlNode& root, ServiceConfig& config) {
  read_seconds(root, "budget", config.budget);
  read_seconds(root, "longest_budget", config.longest_budget);
  if (config.budget <= config.longest_budget) return;
  if (const auto node = root.find("budget")) {
    node->fail(fmt::format("{} s is outside (0, {}], as `longest_budget` is {} s", config.budget, config.longest_budget,
                           config.longest_budget));
  }
  config.budget = config.longest_budget;
}

}  // namespace

ServiceConfig default_service_config() {
  ServiceConfig config;
  config.instance = this_process();
  config.robot = default_robot_file();
  return config;
}

std::vector<ServiceConfig> one_per_robot(const ServiceConfig& config) {
  if (config.robots.empty()) return {config};
  std::vector<ServiceConfig> all;
  for (const ServedRobot& robot : config.robots) {
    ServiceConfig& one = all.emplace_back(config);
    one.robots.clear();
    one.robot_id = robot.id;
    one.robot = robot.file;
    if (config.robots.size() > 1) one.instance = instance_of(config, robot.id);
  }
  return all;
}

WorkerSettings worker_settings(const ServiceConfig& config) {
  return {config.robot, config.warm_plans, config.library, config.jobs, config.rehearsal};
}

ServiceConfig load_service_config(const std::filesystem::path& file) {
  ServiceConfig config = default_service_config();
  const YamlNode root = YamlNode::load(file);
  root.allow_keys({"domain", "instance", "robot_id", "robot", "robots", "workers", "jobs", "queue", "warm_plans",
                   "library", "remember", "metrics", "budget", "longest_budget", "ros2", "security",
                   "allow_insecure_network"});
  read_network(root, file.parent_path(), config.network);
  read_whole(root, "workers", 0, 64, config.workers);
  read_whole(root, "jobs", 1, 256, config.jobs);
  read_whole(root, "queue", 1, 4096, config.queue);
  read_whole(root, "warm_plans", 0, 4096, config.warm_plans);
  read_budgets(root, config);
  read_name(root, "instance", config.instance);
  read_name(root, "robot_id", config.robot_id);
  if (const auto node = root.find("ros2")) read_ros2(*node, config);
  if (const auto node = root.find("metrics")) read_metrics(*node, config);
  if (const auto node = root.find("library")) config.library = folder_named(*node, file);
  if (const auto node = root.find("remember")) config.remember = file.parent_path() / node->text();
  if (const auto node = root.find("robot")) config.robot = file.parent_path() / node->text();
  read_robots(root, file.parent_path(), config);
  return config;
}

}  // namespace fjr
