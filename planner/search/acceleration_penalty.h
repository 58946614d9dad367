// Penalties against oscillation. Objectives that are not strictly convex in the torques do not penalise oscillations of
// springs and motors. If there is time to spare, their optima may oscillate faster than any mesh or rows resolve. Small
// penalties on the links' acceleration and jerk remove that. Plans are still compared by the requested objective alone.
#pragma once

#include <memory>
#include <vector>

#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// Returns variants of a minimum-time problem whose motion takes many seconds at a speed limit, in the order in which
// they are tried until one is certified: with penalties on acceleration and jerk, with less on jerk, and on
// acceleration only.
std::vector<std::shared_ptr<const Problem>> fastest_with_acceleration_penalties(
    const Problem& problem, const AccelerationPenaltySettings& settings);

// Returns the problem of another objective with a weight on the acceleration of the links. Returns null if it has such
// a weight or needs none, because its objective is strictly convex in the torques, is time or a reward, or because
// there is no time to oscillate.
std::shared_ptr<const Problem> with_acceleration_penalty(const Problem& problem,
                                                         const AccelerationPenaltySettings& settings);

// If the best motion was found with that weight, solves again with smaller and smaller weights, as long as this gives
// certified and better motions.
void fade_acceleration_penalty(Findings& found, Session& session);

}  // namespace fjr
