// The analysis as it stands in plan.json; docs/plan-json.md describes the fields.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planner/analysis/analysis.h"

namespace fjr {

nlohmann::ordered_json sensitivity_json(const Sensitivity& sensitivity);
nlohmann::ordered_json optimality_json(const Optimality& optimality);

// Returns {node_times, errors} of at most kMostIntervals intervals, because plan.json is sent in a message of bounded
// size. If there are more, neighbouring intervals are merged, with the larger error.
nlohmann::ordered_json mesh_errors_json(const std::vector<double>& node_times, const std::vector<double>& errors);
inline constexpr std::size_t kMostIntervals = 2000;

// The number of a joint or link, as all of plan.json has it: null for 0, which stands for neither.
nlohmann::ordered_json joint_or_null(int joint);

}  // namespace fjr
