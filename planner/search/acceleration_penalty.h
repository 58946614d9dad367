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

// Returns the problem with a weight on the acceleration of the links for a motion on a coarse mesh, with this scaled
// objective and duration [s], that comes to no plan otherwise: a smooth motion that takes as long would have to pay a
// few per cent of the objective. Slow motions need it where their motors are about as fast as the friction law is wide,
// and move and rest in turns. Returns null if the objective does not depend on friction, is a reward, or there is no
// time to oscillate.
std::shared_ptr<const Problem> with_damping(const Problem& problem, double objective, double duration,
                                            const AccelerationPenaltySettings& settings);

// If the best motion was found with more weight on accelerations than was asked for, solves again with less and less of
// that, as long as this gives certified and better motions.
void fade_acceleration_penalty(Findings& found, Session& session);

}  // namespace fjr
