// Loops over padded rows (rows.h) for the vector units that there are.
//
// FJR_VECTORISED before a function: compiled for newer processors too, and the loader chooses. The level is
// named as the psABI does: a processor's name would never be chosen on another maker's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "planner/nlp/chain/rows.h"

namespace fjr {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define FJR_VECTORISED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define FJR_VECTORISED
#endif

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), may_alias));

// Lane by lane, in place: vectors that are passed by value would be passed otherwise on every level.
[[gnu::always_inline]] inline void make_magnitude(Lanes& value) {
  using Bits = std::int64_t __attribute__((vector_size(kLanes * sizeof(double))));
  value = reinterpret_cast<Lanes>(reinterpret_cast<Bits>(value) & std::numeric_limits<std::int64_t>::max());
}
[[gnu::always_inline]] inline void keep_larger(Lanes& largest, const Lanes& value) {
  largest = value > largest ? value : largest;
}
[[gnu::always_inline]] inline double largest_lane(const Lanes& value) {
  return std::max(std::max(value[0], value[1]), std::max(value[2], value[3]));
}

}  // namespace fjr
