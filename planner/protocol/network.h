// The DDS domain and identity of a program: the same settings for every program that can move or stop an arm.
#pragma once

#include <filesystem>

namespace fjr {

class YamlNode;

// Returns the folder in the environment variable FJR_SECURITY; empty: DDS Security is off.
std::filesystem::path credentials_from_environment();

struct Network {
  unsigned domain = 0;                                              // of DDS
  std::filesystem::path security = credentials_from_environment();  // folder of credentials; empty: none
  bool allow_insecure_network = false;  // may use other interfaces than loopback without security
};

// Reads the keys `domain`, `security` (relative to `folder`) and `allow_insecure_network` of a configuration file.
void read_network(const YamlNode& root, const std::filesystem::path& folder, Network& to);

}  // namespace fjr
