#include "planner/protocol/document.h"

#include <fmt/format.h>

#include <string_view>

#include "common/strict_yaml.h"

namespace fjr {
namespace {

// `first` ("key: value"), if any, then all entries but `left_out`.
std::string rewritten(const YamlNode& root, const std::string& first, std::string_view left_out) {
  std::string entries = first;
  for (const std::string& key : root.keys()) {
    if (key == left_out) continue;
    fmt::format_to(std::back_inserter(entries), "{}{}: {}", entries.empty() ? "" : ", ", quoted_flow(key),
                   root.at(key).flow());
  }
  return "{" + entries + "}";
}

}  // namespace

std::string without_robot(const std::string& document, const std::string& source) {
  return rewritten(YamlNode::parse(document, source), "", "robot");
}

bool gives_start(const std::string& document, const std::string& source) {
  const auto start = YamlNode::parse(document, source).find("start");
  return start && !start->is_null() && !(start->is_map() && start->keys().empty());
}

std::string with_start(const std::string& document, const std::string& source, const Pair<double>& q) {
  return rewritten(YamlNode::parse(document, source), fmt::format("start: {{q: [{}, {}]}}", q[0], q[1]), "start");
}

}  // namespace fjr
