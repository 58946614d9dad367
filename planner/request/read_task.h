// The task constraints of a request.
#pragma once

#include "common/strict_yaml.h"
#include "planner/problem/problem.h"

namespace fjr {

// Reads `obstacles`, `tip` and `path`. A path also becomes via points at its corners, which leaves no room for others.
// Throws InputError for what is malformed.
void read_task(const YamlNode& root, Problem& problem);

// Throws InputError where start, goal or a via point breaks the task: a contradiction that needs no optimiser to find.
// Goals that do are taken out as long as another remains.
void check_task(const YamlNode& root, Problem& problem);

}  // namespace fjr
