// A plan as one HTML page that needs nothing but itself: the arm in motion beside plots that share its time, margins,
// certificate, what planning without the springs would have done, mesh, solver, request.
#pragma once

#include <string>

#include "planner/results/report/plan_record.h"

namespace fjr {

// Rolls out two textbook profiles on the way (rigid_profile.h). InputError: record.plan lacks something or holds it in
// another form. Sections of plan.json that this page does not know are shown as they are.
std::string plan_page(const PlanRecord& record);

}  // namespace fjr
