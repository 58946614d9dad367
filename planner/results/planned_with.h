// What a trajectory file says in its header of the payload and of the limits that it was planned with:
//   # payload: 0.1 kg
//   # payload.inertia: 0.001 kg m^2
//   # limits.torque[0]: 10 N m           (those alone that are tighter than the robot's)
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/csv.h"
#include "planner/problem/problem.h"

namespace fjr {

struct LimitInHeader {
  std::size_t index = 0;  // in kLimitNames
  double value = 0;       // > 0

  std::string key() const;  // "limits.torque[0]"
  std::string unit() const { return kLimitNames[index].quantity->unit; }

  std::string text() const;  // "limits.torque[0] 10 N m"
};

struct PlannedWith {
  std::optional<Payload> payload;  // none: the file does not say
  std::vector<LimitInHeader> limits;
};

std::string text_of(const Payload& payload);  // "0.1 kg", "0.1 kg, 0.001 kg m^2"

// Adds the lines for a plan, by its plan.json.
void tell_planned_with(const nlohmann::ordered_json& plan, Metadata& metadata);

// The robot's limits, and those in the header that are tighter.
Limits limits_of(const Parameters& robot, const PlannedWith& header);

// Throws InputError naming `source` and the line's key where a value is not what the lines above show.
PlannedWith planned_with(const Metadata& metadata, const std::string& source);

}  // namespace fjr
