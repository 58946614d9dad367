// Loops over padded rows (rows.h) for the vector units that there are.
//
// FJR_VECTORISED before a function: compiled for newer processors too, and the loader chooses. The level is
// named as the psABI does: a processor's name would never be chosen on another maker's.
#pragma once

#include "planner/nlp/chain/rows.h"

namespace fjr {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define FJR_VECTORISED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define FJR_VECTORISED
#endif

using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), may_alias));

}  // namespace fjr
