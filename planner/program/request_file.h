// Reads requests that the command line names: files, or `-` for standard input.
#pragma once

#include <filesystem>
#include <string>

#include "common/strict_yaml.h"
#include "planner/request/request.h"

namespace fjr {

inline constexpr const char* kStandardInput = "-";

struct RequestFile {
  std::string text;
  std::string source;            // for messages; its stem is the plan's name: that of standard input is `stdin`
  std::filesystem::path folder;  // what a relative `robot` is relative to
};

// Returns the name of a request in messages, without reading it.
std::filesystem::path source_of(const std::string& named);

// Throws InputError if it cannot be read.
RequestFile read_request_file(const std::string& named);

// A request as it was read, before it is resolved to numbers.
struct NamedRequest {
  YamlNode document;
  Request request;
  std::filesystem::path folder;  // as above
};

// Throws InputError if it cannot be read or is malformed.
NamedRequest read_named(const std::string& named);

struct ResolvedRequest {
  Problem problem;
  std::filesystem::path robot;
};

// robot: the file of --robot; empty: not given. Throws InputError where resolve() does, and if the request names a
// robot beside it.
ResolvedRequest resolve_named(const NamedRequest& named, const std::string& robot);

}  // namespace fjr
