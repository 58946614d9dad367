// Where there is time to spare, objectives that are not strictly convex in the torques do not penalise oscillations of
// springs and motors, and their optima may oscillate faster than any mesh or rows resolve. Small penalties on the
// links' acceleration and jerk remove that. Plans are compared by the objective that was asked for alone.
#pragma once

#include <memory>
#include <vector>

#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// The problem of a fastest motion of many seconds, at a speed limit all the way, with both penalties, in the
// order in which they are tried until one is certified.
std::vector<std::shared_ptr<const Problem>> fastest_with_acceleration_penalties(const Problem& problem);

// The problem of another objective with a weight on the acceleration of the links; null where it has one, or needs
// none: because its objective is curved in the torques, is time or a reward, or because there is no time to swing.
std::shared_ptr<const Problem> with_acceleration_penalty(const Problem& problem);

// Where the best motion was found with that weight: solves again with less and less of it, as long as certified and
// better motions come of it.
void fade_acceleration_penalty(Findings& found, Session& session);

}  // namespace fjr
