// The task constraints of a plan.json.
#pragma once

#include "planner/problem/task/shapes.h"
#include "planner/results/json_field.h"

namespace fjr {

// Reads resolved_request.task of a plan.json. Throws InputError for what is missing or no task.
Task task_of_plan(const JsonField& plan);

}  // namespace fjr
