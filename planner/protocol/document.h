// Request documents on their way: what of a request file goes to the service.
#pragma once

#include <string>

namespace fjr {

// One line, without `robot`: that names a file of the client's. What else it says is the service's to judge, which may
// be of a later version. source: for messages. Throws InputError for what is not a YAML map.
std::string without_robot(const std::string& document, const std::string& source);

}  // namespace fjr
