// The task constraints of a request.
#pragma once

#include "planner/problem/problem.h"
#include "planner/request/request.h"

namespace fjr {

// Resolves `obstacles`, `tip` and `path`. A path also becomes via points at its corners, so that a request with a path
// can have no others. Throws InputError for values that make no sense.
void resolve_task(const Request& request, Problem& problem);

// Throws InputError if start, goal or a via point violates the task, which shows without optimisation. Alternative
// goals that violate it are removed as long as another one remains.
void check_task(const Request& request, Problem& problem);

}  // namespace fjr
