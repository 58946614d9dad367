// Where and as whom a program takes part in DDS: the same settings for every program that can move or stop an arm.
#pragma once

#include <filesystem>

namespace fjr {

class YamlNode;

// What the environment variable FJR_SECURITY names; empty: nothing, DDS Security is off.
std::filesystem::path credentials_from_environment();

struct Network {
  unsigned domain = 0;                                              // of DDS
  std::filesystem::path security = credentials_from_environment();  // folder of credentials; empty: none
  bool allow_insecure_network = false;                              // beyond the loopback interface without
};

// The keys `domain`, `security` (relative to `folder`) and `allow_insecure_network` of a configuration file.
void read_network(const YamlNode& root, const std::filesystem::path& folder, Network& to);

}  // namespace fjr
