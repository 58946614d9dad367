// A key of a map that users write, as reading, writing and documenting it go by.
#pragma once

#include <string_view>

namespace fjr {

inline constexpr const char* kNeeded = "needed";

struct Key {
  const char* name;
  const char* unit;  // of numbers; "" where there are none
  const char* meaning;
  const char* otherwise = "";  // what counts when it is left out; kNeeded where it may not be; "" where nothing does
  const char* allowed = "";    // beside what its meaning says

  bool required() const { return otherwise == std::string_view(kNeeded); }
};

}  // namespace fjr
