// Support for loops over padded rows (rows.h) that use the vector instructions of the processor they run on.
//
// A function marked FJR_VECTORISED is compiled a second time for newer processors, and the loader chooses one at run
// time. The level is named as in the x86-64 psABI, because a variant named after one maker's processor would not be
// chosen on another maker's.
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

// These work lane by lane and by reference, because the calling convention for vectors by value depends on the level.
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
