// Text from others, made fit for logs and terminals.
#pragma once

#include <string>
#include <string_view>

namespace fjr {

// `text` with everything escaped that is no visible UTF-8 on one line: control characters as \n, \t or \u001b, what
// turns the direction of writing or breaks lines as \u202e, bytes that are no UTF-8 as \xff. All else is left as it is,
// so that names of robots and instances stay the same.
std::string printable(std::string_view text);

// The same of text in several lines, such as JSON, where such escapes have the same meaning.
std::string printable_lines(std::string_view text);

}  // namespace fjr
