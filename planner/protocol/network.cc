#include "planner/protocol/network.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>

#include "common/strict_yaml.h"
#include "planner/protocol/bounded_name.h"
#include "planner/protocol/messages.h"

namespace fjr {
namespace {

constexpr std::uint64_t kLargestDomain = 230;

}  // namespace

std::filesystem::path credentials_from_environment() {
  const char* folder = std::getenv("FJR_SECURITY");
  return folder == nullptr ? "" : folder;
}

void read_network(const YamlNode& root, const std::filesystem::path& folder, Network& to) {
  if (const auto node = root.find("domain")) to.domain = static_cast<unsigned>(node->whole_number(0, kLargestDomain));
  if (const auto node = root.find("security")) to.security = folder / node->text();
  if (const auto node = root.find("allow_insecure_network")) to.allow_insecure_network = node->truth();
}

void read_name(const YamlNode& root, std::string_view key, std::string& to) {
  const auto node = root.find(key);
  if (!node) return;
  to = node->text();
  if (to.size() > kLongestName) node->fail(fmt::format("{} characters, above the {} allowed", to.size(), kLongestName));
}

}  // namespace fjr
