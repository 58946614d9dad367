// From the solution of a neighbouring request to a plan for this one.
#pragma once

#include <string>

#include "planner/search/findings.h"

namespace fjr {

// Empty when that led to a certified plan, which `found` then has; otherwise why it did not, a clause.
std::string start_warm(const Collocated& neighbour, Findings& found, Session& session);

}  // namespace fjr
