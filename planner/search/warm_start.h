// Plans a request from the solution of a neighbouring one.
#pragma once

#include <optional>
#include <string>

#include "planner/search/findings.h"

namespace fjr {

// Puts a certified plan into `found`, or returns a clause that says why none came of it.
std::optional<std::string> start_warm(const Collocated& neighbour, Findings& found, Session& session);

}  // namespace fjr
