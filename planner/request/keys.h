// The list of all keys of a request, for people and programs.
#pragma once

#include <string>
#include <vector>

namespace fjr {

// One key of a request, with the texts of its Key.
struct KeyLine {
  std::string name;  // with the keys above it: goal.q, via[].time
  std::string unit, meaning, otherwise, allowed;
};

// Returns all keys, in the order of request.h, the limits and the terms of the objective.
std::vector<KeyLine> all_keys();

// Returns the unit of the number at a path such as goal.q[1] or via[0].time; empty if it has none.
std::string unit_of_key(const std::string& path);

// Returns the keys as the table of docs/requests.md.
std::string keys_table();

}  // namespace fjr
