// plan.json: what became of a request, for machines.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "planner/plan.h"

namespace fjr {

// Everything but `timing` is the same for the same request, binary and machine. Numbers that are not finite become
// null, and so does what a plan without a trajectory cannot have.
nlohmann::ordered_json plan_json(const Problem& problem, const Plan& plan);

// For a request that never became a Problem. name: of the request file, without extension. field: what the reason is
// about, as InputError::field(); empty where it is about no field, then it becomes null.
nlohmann::ordered_json bad_input_json(const std::string& name, const std::string& reason, const std::string& field);

// The settings of the search that differ from their defaults, by their keys: {"race.gaps[0].width": 0.02}.
nlohmann::ordered_json settings_json(const SearchSettings& settings);

// A request as it was understood: everything resolved, null where the motion is free.
nlohmann::ordered_json resolved_request_json(const Problem& problem);

nlohmann::ordered_json certificate_json(const Certificate& certificate);
nlohmann::ordered_json limit_json(const LimitCheck& check);
nlohmann::ordered_json task_json(const TaskCheck& check);

// Indented, ending with a new line. Text from outside that is not UTF-8 is replaced, never an error.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace fjr
