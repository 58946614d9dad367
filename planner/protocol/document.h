// Request documents (DESIGN 5.2) on their way: what of a request file goes to the service, and what the service adds.
#pragma once

#include <string>

#include "model/parameters.h"

namespace fjr {

// All throw InputError for what is not a YAML map. source: for messages.

// One line, without `robot`: that names a file of the client's.
std::string without_robot(const std::string& document, const std::string& source);

// False: `start` is absent or empty.
bool gives_start(const std::string& document, const std::string& source);

// The document with a start at rest at link positions q [rad], instead of none.
std::string with_start(const std::string& document, const std::string& source, const Pair<double>& q);

}  // namespace fjr
