// How many members an aggregate has, so that a list of them can be held to be complete when it is compiled.
#pragma once

#include <cstddef>

namespace fjr {

// Stands for any value in braces; it is never evaluated.
struct AnyValue {
  template <class T>
  constexpr operator T() const;
};

// Returns the number of members that can be given in braces, `Given` of which are known to be possible. A member that
// is itself an aggregate or an array counts as one.
template <class Aggregate, class... Given>
consteval std::size_t field_count() {
  if constexpr (requires { Aggregate{Given{}..., AnyValue{}}; }) {
    return field_count<Aggregate, Given..., AnyValue>();
  } else {
    return sizeof...(Given);
  }
}

}  // namespace fjr
