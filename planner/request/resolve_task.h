// The task constraints of a request.
#pragma once

#include "planner/problem/problem.h"
#include "planner/request/request.h"

namespace fjr {

// Resolves `obstacles`, `tip` and `path`. A path also becomes via points at its corners, which leaves no room for
// others. Throws InputError for what makes no sense.
void resolve_task(const Request& request, Problem& problem);

// Throws InputError where start, goal or a via point breaks the task: a contradiction that needs no optimiser to find.
// Goals that do are taken out as long as another remains.
void check_task(const Request& request, Problem& problem);

}  // namespace fjr
