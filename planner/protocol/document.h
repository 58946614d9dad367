// Prepares request files for sending to the service.
#pragma once

#include <string>

namespace fjr {

// Returns the document as one line without `robot`, which names a file of the client's. The service judges all else,
// since it may be of a later version. source: for messages. Throws InputError if it is no YAML map.
std::string without_robot(const std::string& document, const std::string& source);

}  // namespace fjr
