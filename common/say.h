// Prints messages for the user. Errors in writing, as with a closed terminal or a full disk, do not interrupt the work;
// lost output on stdout is reported at the end (main.cc).
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>

namespace fjr {

template <class... T>
void say_in(std::FILE* file, fmt::format_string<T...> format, T&&... arguments) {
  const std::string text = fmt::format(format, std::forward<T>(arguments)...);
  (void)std::fwrite(text.data(), 1, text.size(), file);  // fmt::print would throw
}

template <class... T>
void say(fmt::format_string<T...> format, T&&... arguments) {
  say_in(stderr, format, std::forward<T>(arguments)...);
}

}  // namespace fjr
