// Plans a request from the solution of a neighbouring one.
#pragma once

#include <string>

#include "planner/search/findings.h"

namespace fjr {

// Returns an empty string if that gives a certified plan, which is then in `found`; otherwise a clause that says why
// not.
std::string start_warm(const Collocated& neighbour, Findings& found, Session& session);

}  // namespace fjr
