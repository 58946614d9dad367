// Bounded strings of the wire, which nothing obliges to end with a zero.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

namespace fjr::dds {

template <std::size_t N>
std::string text_of(const char (&bounded)[N]) {
  return std::string(bounded, ::strnlen(bounded, N));
}

// Cut to what fits, never within a UTF-8 character.
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
