// The list of all keys of a request, for people and programs.
#pragma once

#include <string>
#include <vector>

namespace fjr {

// One key, as Key has it.
struct KeyLine {
  std::string name;  // with those above it: goal.q, via[].time
  std::string unit, meaning, otherwise, allowed;
};

// In the order in which request.h, the limits and the terms of the objective have them.
std::vector<KeyLine> all_keys();

// Of the number at a path such as goal.q[1] or via[0].time; empty where it has none.
std::string unit_of_key(const std::string& path);

// As the table of docs/requests.md.
std::string keys_table();

}  // namespace fjr
