#include "planner/program/request_file.h"

#include <iostream>

#include "common/strict_yaml.h"

namespace fjr {

std::filesystem::path source_of(const std::string& named) { return named == kStandardInput ? "stdin" : named; }

RequestFile read_request_file(const std::string& named) {
  const std::filesystem::path source = source_of(named);
  if (named == kStandardInput) return {read_document(std::cin, source.string()), source.string(), "."};
  return {read_document(source), source.string(), source.parent_path()};
}

}  // namespace fjr
