// What is said to people while work goes on, which it does, too, where nobody can read it, as on a terminal that was
// closed or a full disk. What stdout has lost is told in the end (main.cc).
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
