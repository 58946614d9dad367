// A plan as one self-contained HTML page: an animation of the arm beside plots with the same time axis, margins,
// certificate, a comparison with planning without the springs, mesh, solver, request.
#pragma once

#include <string>

#include "planner/results/report/plan_record.h"

namespace fjr {

// Returns the HTML. For the comparison it rolls out two textbook profiles (rigid_profile.h). Unknown sections of
// plan.json are shown as they are. Throws InputError if record.plan lacks a field or has it in another form.
std::string plan_page(const PlanRecord& record);

}  // namespace fjr
