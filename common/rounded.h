// Rounds numbers for display.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <iterator>
#include <system_error>

namespace fjr {

// Returns the value rounded to 1 to 17 significant digits, independently of the locale. (strtod() would stop at the
// decimal point in a locale with a comma.)
inline double rounded_to(double value, int digits) {
  fmt::basic_memory_buffer<char, 32> text;
  fmt::format_to(std::back_inserter(text), "{:.{}e}", value, digits - 1);
  double rounded = value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rounded);
  return error == std::errc() ? rounded : value;
}

}  // namespace fjr
