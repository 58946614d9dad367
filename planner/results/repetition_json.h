// What plan.json and the header of a trajectory say of a motion whose rows were learnt: docs/plan-json.md.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "common/csv.h"
#include "planner/learning/repetition.h"

namespace fjr {

// run: the members that tell by which run; number: of the repetition, where the plan as it was planned is the first.
nlohmann::ordered_json repetition_json(const Repetition& repetition, const nlohmann::ordered_json& run, int number);

// Which one the rows are that go with a plan.json; 1: as it was planned.
int number_of_repetition(const nlohmann::ordered_json& plan);

// Adds the lines of rows that go with it, where they were learnt; otherwise none.
void tell_repetition(const nlohmann::ordered_json& plan, Metadata& metadata);

}  // namespace fjr
