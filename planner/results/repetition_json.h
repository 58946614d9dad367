// What plan.json and the header of a trajectory say of a motion whose rows were learnt: docs/plan-json.md. What reads
// plan.json throws InputError naming the field that is missing or of another kind.
#pragma once

#include <optional>
#include <string>

#include "common/csv.h"
#include "planner/learning/repetition.h"
#include "planner/results/json_field.h"

namespace fjr {

// run: the members that tell by which run; plan: the plan.json that goes with the rows which were executed.
nlohmann::ordered_json repetition_json(const Repetition& repetition, const nlohmann::ordered_json& run,
                                       const JsonField& plan);

// [rad] of the motors at the start of the last run before the one of these rows that something could be learnt from;
// none: none is told. Reads all that is told of runs.
std::optional<Joints<double>> motors_began_before(const JsonField& plan);

// What a service has taken of the correction by a run, whose id it is; none where it took nothing, and where nobody can
// read it.
struct TakenCorrection {
  std::string run;
  double fraction = 0;  // above 0, up to 1
};
std::optional<TakenCorrection> correction_in(const std::string& plan_json);

// Adds the lines of rows that go with a plan.json, where they were learnt; otherwise none.
void tell_repetition(const nlohmann::ordered_json& plan, Metadata& metadata);

}  // namespace fjr
