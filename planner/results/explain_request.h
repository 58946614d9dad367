// What a request asks for, key by key, with what counts where it says nothing: told without planning.
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
  std::string value;    // as it would stand in a request; or words, where nothing counts ("none")
  std::string shown;    // the same for people: what was computed, without its last digits
  std::string note;     // what else there is to say of it: "to either side of [0.1, -0.85]"; mostly empty
  std::string meaning;  // as `fjr keys` has it
  bool given = false;   // by the request; otherwise it is the default that applies
};

// In the order of all_keys(). root: the document that was resolved to `problem`; robot: the file of the robot.
std::vector<UnderstoodKey> understood(const YamlNode& root, const Problem& problem, const std::string& robot);

// A line for each, defaults marked; weights of nothing and the like are left out.
std::string explanation_of_request(const std::string& name, const std::vector<UnderstoodKey>& keys);
nlohmann::ordered_json explanation_json(const std::string& name, const std::vector<UnderstoodKey>& keys);

}  // namespace fjr
