// Numbers as they are told to people.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <iterator>
#include <system_error>

namespace fjr {

// The value rounded to so many significant digits, from 1 to 17. Whatever the locale of the process: a text that is
// read back by strtod() would end at its point where the locale has a comma.
inline double rounded_to(double value, int digits) {
  fmt::basic_memory_buffer<char, 32> text;
  fmt::format_to(std::back_inserter(text), "{:.{}e}", value, digits - 1);
  double rounded = value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rounded);
  return error == std::errc() ? rounded : value;
}

}  // namespace fjr
