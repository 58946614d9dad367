// The description of a learnt motion in plan.json and in the header of a trajectory (docs/plan-json.md). Functions that
// read plan.json throw InputError naming the field that is missing or of the wrong type.
#pragma once

#include <optional>
#include <string>

#include "common/csv.h"
#include "planner/learning/repetition.h"
#include "planner/results/json_field.h"

namespace fjr {

// run: the members that identify the run it was learnt from; plan: the plan.json of the rows that were executed.
nlohmann::ordered_json repetition_json(const Repetition& repetition, const nlohmann::ordered_json& run,
                                       const JsonField& plan);

// Returns the motor positions [rad] at the start of the last earlier run from which something was learnt; nothing if
// there is none. Reads, and so checks, all data about runs.
std::optional<Joints<double>> motors_began_before(const JsonField& plan);

// The fraction of a correction that a service has applied, and the id of the run it is based on. correction_in()
// returns nothing if none was applied or the data cannot be read.
struct TakenCorrection {
  std::string run;
  double fraction = 0;  // above 0, up to 1
};
std::optional<TakenCorrection> correction_in(const std::string& plan_json);

// Adds the header lines of rows that were learnt, from their plan.json; adds none otherwise.
void tell_repetition(const nlohmann::ordered_json& plan, Metadata& metadata);

}  // namespace fjr
