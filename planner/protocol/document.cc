#include "planner/protocol/document.h"

#include <fmt/format.h>

#include "common/strict_yaml.h"

namespace fjr {

std::string without_robot(const std::string& document, const std::string& source) {
  const YamlNode root = YamlNode::parse(document, source);
  std::string entries;
  for (const std::string& key : root.keys()) {
    if (key == "robot") continue;
    fmt::format_to(std::back_inserter(entries), "{}{}: {}", entries.empty() ? "" : ", ", quoted_flow(key),
                   root.at(key).flow());
  }
  return "{" + entries + "}";
}

}  // namespace fjr
