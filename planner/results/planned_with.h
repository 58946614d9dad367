// The payload and the limits that a trajectory was planned with, as the header of its file gives them:
//   # payload: 0.1 kg
//   # payload.inertia: 0.001 kg m^2
//   # limits.torque[0]: 10 N m           (only those that are tighter than the robot's)
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
  std::optional<Payload> payload;  // empty if the file does not contain it
  std::vector<LimitInHeader> limits;
};

std::string text_of(const Payload& payload);  // "0.1 kg", "0.1 kg, 0.001 kg m^2"

// Adds these lines for a plan, from its plan.json.
void tell_planned_with(const nlohmann::ordered_json& plan, Metadata& metadata);

// Returns the robot's limits, tightened by those in the header.
Limits limits_of(const Parameters& robot, const PlannedWith& header);

// Returns what is wrong with a header that leaves out a limit of plan.json, or tells a wider one: a sentence without
// its subject, which is the file.
std::string leaves_out(const LimitName& limit, double planned);

// Throws InputError naming `source` and the key of the line if a value does not have the form above.
PlannedWith planned_with(const Metadata& metadata, const std::string& source);

}  // namespace fjr
