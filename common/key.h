// A key of a map that users write, as reading, writing and documenting it go by.
#pragma once

namespace fjr {

struct Key {
  const char* name;
  const char* unit;     // of numbers; "" where there are none
  const char* meaning;  // for who reads the list; docs/requests.md says more
  bool required = false;
};

}  // namespace fjr
