// Bounded strings of the wire, which need not end with a zero and may contain unprintable characters.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

#include "planner/protocol/printable.h"

namespace fjr::dds {

// Returns the text as it was sent, for use by programs.
template <std::size_t N>
std::string raw_text_of(const char (&bounded)[N]) {
  return std::string(bounded, ::strnlen(bounded, N));
}

// Returns the text in a form that is safe for logs and terminals. All text from other participants is converted this
// way.
template <std::size_t N>
std::string text_of(const char (&bounded)[N]) {
  return printable(raw_text_of(bounded));
}

// Copies a text, truncated to the size of the field but never within a UTF-8 character.
template <std::size_t N>
void set_text(char (&bounded)[N], std::string_view text) {
  std::size_t length = std::min(text.size(), N - 1);
  if (length < text.size()) {
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) --length;
  }
  const auto end = std::copy_n(text.begin(), length, bounded);
  *end = '\0';
}

}  // namespace fjr::dds
