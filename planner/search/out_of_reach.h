// Decides whether a request is worth more starts after the first one failed. More iterations, other meshes and limits
// tightened step by step cost ten times as much as finding out what is missing, and for most infeasible requests they
// find nothing.
#pragma once

#include <optional>

#include "planner/problem/problem.h"
#include "planner/search/session.h"
#include "planner/search/settings.h"

namespace fjr {

// What is clearly out of reach, so that no more is tried.
enum class OutOfReach {
  kVelocity,   // the goal or a via point moves too fast, whatever time there is
  kViaTime,    // the fastest motion to a via point gets there too late
  kAllLimits,  // all of them together would have to be larger
};

// Returns whether a link is to move much faster than its motor may. Springs hardly add as much again, so that
// reachability is checked before the first start.
bool asks_for_more_speed_than_motors_have(const Problem& problem, const OutOfReachSettings& settings);

// Returns why the request is out of reach, if that is clear: a velocity, a via point's time or all limits are missed by
// more than the fractions of OutOfReachSettings. The numbers come from problems with a smoothed friction law on coarse
// meshes, which cannot tell what is only just out of reach. Arms that have to swing up and motions with a task are not
// judged, because the least excess found there is that of one path among others.
std::optional<OutOfReach> out_of_reach(const Problem& problem, Session& session);

}  // namespace fjr
