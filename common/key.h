// A key of a map in user files. Reading, writing and documentation all use this description.
#pragma once

#include <string_view>

namespace fjr {

inline constexpr const char* kNeeded = "needed";

struct Key {
  const char* name;
  const char* unit;  // of numbers; "" where there are none
  const char* meaning;
  const char* otherwise = "";  // default if it is left out; kNeeded if it must not be; "" if there is none
  const char* allowed = "";    // allowed values, if its meaning does not say

  bool required() const { return otherwise == std::string_view(kNeeded); }
};

}  // namespace fjr
