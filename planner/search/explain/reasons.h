// One function for each kind of reason why a request has no plan. Each adds what it finds to the explanation.
#pragma once

#include <cstddef>

#include "planner/search/detours.h"
#include "planner/search/explain/explanation.h"

namespace fjr {

// There is no path that keeps clear of the obstacles and regions.
void explain_barred(const NoPath& barred, Explanation& e);

// Even the fastest motion, which is known, takes longer than is allowed.
void explain_duration(Explanation& e);

// Via points cannot be passed at the requested times. Does nothing if that is not the reason.
void explain_via_times(Explanation& e);

// Reports a time [s] of a via point, from `time` on, and a duration that are enough together where neither can be kept.
// Both have a little to spare and are verified by planning. fastest: the fastest motion, whatever its times. Returns
// false if none are found.
bool tell_both(Explanation& e, std::size_t via, double time, const Continuation& fastest);

// No motion that was found keeps every limit.
void explain_limits(Explanation& e);

}  // namespace fjr
