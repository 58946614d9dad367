// Names that are sent as bounded strings: of robots, and of instances.
#pragma once

#include <string>
#include <string_view>

namespace fjr {

class YamlNode;

// Reads the name under `key`, if it is there. Throws InputError if it is longer than kLongestName bytes: truncated, it
// could be another's.
void read_name(const YamlNode& root, std::string_view key, std::string& to);

}  // namespace fjr
