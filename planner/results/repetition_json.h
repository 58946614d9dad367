// What plan.json and the header of a trajectory say of a motion whose rows were learnt: docs/plan-json.md. What reads
// plan.json throws InputError naming the field that is missing or of another kind.
#pragma once

#include <optional>

#include "common/csv.h"
#include "planner/learning/repetition.h"
#include "planner/results/json_field.h"

namespace fjr {

// run: the members that tell by which run; plan: the plan.json that goes with the rows which were executed.
nlohmann::ordered_json repetition_json(const Repetition& repetition, const nlohmann::ordered_json& run,
                                       const JsonField& plan);

// [rad] of the motors at the start of the run before the one of these rows; none: it is not told.
std::optional<Joints<double>> motors_began_before(const JsonField& plan);

// Adds the lines of rows that go with a plan.json, where they were learnt; otherwise none.
void tell_repetition(const nlohmann::ordered_json& plan, Metadata& metadata);

}  // namespace fjr
