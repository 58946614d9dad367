#include "planner/program/request_file.h"

#include <iostream>
#include <utility>

#include "common/input_error.h"
#include "planner/request/request_keys.h"

namespace fjr {

std::filesystem::path source_of(const std::string& named) { return named == kStandardInput ? "stdin" : named; }

RequestFile read_request_file(const std::string& named) {
  const std::filesystem::path source = source_of(named);
  if (named == kStandardInput) return {read_document(std::cin, source.string()), source.string(), "."};
  return {read_document(source), source.string(), source.parent_path()};
}

NamedRequest read_named(const std::string& named) {
  const RequestFile file = read_request_file(named);
  YamlNode document = YamlNode::parse(file.text, file.source);
  Request request = read_request(document);
  return {std::move(document), std::move(request), file.folder};
}

ResolvedRequest resolve_named(const NamedRequest& named, const std::string& robot) {
  if (named.request.robot && !robot.empty()) {
    throw InputError(named.request.source, "robot", "is named already; --robot is for requests that name none");
  }
  const std::filesystem::path file = robot_file_of(named.request, named.folder, robot);
  return {resolve(named.request, load_parameters(file)), file};
}

}  // namespace fjr
