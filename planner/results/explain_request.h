// Explains a request key by key, including the defaults that apply, without planning it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/strict_yaml.h"
#include "planner/problem/problem.h"

namespace fjr {

struct UnderstoodKey {
  std::string key;      // "start.dq", "via[0].time"
  std::string unit;     // "" where there is none
  std::string value;    // in the form of a request; words if there is no value ("none")
  std::string shown;    // the value for display: computed numbers are rounded
  std::string note;     // an additional remark, such as "to either side of [0.1, -0.85]"; mostly empty
  std::string meaning;  // as `fjr keys` has it
  bool given = false;   // whether the request gives it; otherwise `value` is the default
};

// Returns the keys in the order of all_keys(). root: the document from which `problem` was resolved; robot: the file of
// the robot.
std::vector<UnderstoodKey> understood(const YamlNode& root, const Problem& problem, const std::string& robot);

// Returns one line per key, with defaults marked; irrelevant ones such as zero weights are left out.
std::string explanation_of_request(const std::string& name, const std::vector<UnderstoodKey>& keys);
nlohmann::ordered_json explanation_json(const std::string& name, const std::vector<UnderstoodKey>& keys);

}  // namespace fjr
