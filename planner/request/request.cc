#include "planner/request/request.h"

#include <fmt/format.h>

#include "planner/request/place.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

Parameters robot_of(const Request& request, const fs::path& folder, const fs::path& default_robot) {
  return load_parameters(robot_file_of(request, folder, default_robot));
}

}  // namespace

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
