// Whether a request for which the first start led nowhere is worth more of them. Patience, other meshes and limits that
// are tightened step by step cost ten times what it costs to ask what is missing, and for most requests that cannot be
// had they find nothing.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/session.h"

namespace fjr {

// What no motion gets to, so that no more is tried.
enum class OutOfReach {
  kVelocity,   // the goal or a via point moves too fast, whatever time there is
  kViaTime,    // the fastest motion to a via point gets there too late
  kAllLimits,  // all of them together would have to be larger
};

// Whether a link is to move more than twice as fast as its motor may: springs hardly add as much again, so that it is
// asked before the first start whether that is out of reach.
bool asks_for_more_speed_than_motors_have(const Problem& problem);

// Whether the fastest motion takes longer than is allowed, by a sketch of it, which is some per cent slower than what
// it becomes: a reason to look closer, and no verdict. Arms that have to swing up are not judged here either.
bool seems_too_short(const Problem& problem, Session& session);

// A cause is told only where it is clear: by half of a velocity, a twentieth of a via point's time, half of all limits.
// The numbers come from optimising with a smoothed friction law on coarse meshes, which cannot tell what is only just
// out of reach. Arms that have to swing up and motions with a task are not judged: the least excess found there is that
// of one way among others.
std::optional<OutOfReach> out_of_reach(const Problem& problem, Session& session);

}  // namespace fjr
