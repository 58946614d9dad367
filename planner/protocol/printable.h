// Makes received text safe for logs and terminals.
#pragma once

#include <string>
#include <string_view>

namespace fjr {

// Returns `text` with everything escaped that is not visible UTF-8 on one line: control characters as \n, \t or \u001b,
// characters that change the direction of writing or break lines as \u202e, bytes that are no UTF-8 as \xff. All else
// stays, so that names of robots and instances remain the same.
std::string printable(std::string_view text);

// Does the same for text of several lines, such as JSON, where such escapes have the same meaning.
std::string printable_lines(std::string_view text);

}  // namespace fjr
