#include "planner/service/service_config.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>

#include "model/parameters.h"
#include "model/strict_yaml.h"

namespace fjr {
namespace {

std::string this_process() {
  std::array<char, 48> host{};
  ::gethostname(host.data(), host.size() - 1);
  return fmt::format("{}-{}", host.data(), ::getpid());
}

template <class Whole>
void read_whole(const YamlNode& root, std::string_view key, std::uint64_t least, std::uint64_t most, Whole& to) {
  const auto node = root.find(key);
  if (!node) return;
  const std::uint64_t value = node->whole_number();
  if (value < least || value > most) node->fail(fmt::format("{} is outside [{}, {}]", value, least, most));
  to = static_cast<Whole>(value);
}

void read_seconds(const YamlNode& root, std::string_view key, double& to) {
  const auto node = root.find(key);
  if (!node) return;
  to = node->number("s");
  if (!(to > 0) || to > 86400) node->fail(fmt::format("{} s is outside (0, 86400]", to));
}

}  // namespace

ServiceConfig default_service_config() {
  ServiceConfig config;
  config.instance = this_process();
  config.robot = default_robot_file();
  return config;
}

ServiceConfig load_service_config(const std::filesystem::path& file) {
  ServiceConfig config = default_service_config();
  const YamlNode root = YamlNode::load(file);
  root.allow_keys({"domain", "instance", "robot_id", "robot", "workers", "queue", "budget", "longest_budget"});
  read_whole(root, "domain", 0, 230, config.domain);
  read_whole(root, "workers", 1, 64, config.workers);
  read_whole(root, "queue", 1, 4096, config.queue);
  read_seconds(root, "budget", config.budget);
  read_seconds(root, "longest_budget", config.longest_budget);
  if (const auto node = root.find("instance")) config.instance = node->text();
  if (const auto node = root.find("robot_id")) config.robot_id = node->text();
  if (const auto node = root.find("robot")) config.robot = file.parent_path() / node->text();
  return config;
}

}  // namespace fjr
