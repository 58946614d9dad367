// Objectives that leave the springs free to swing and the motors to tremble, where there is time to: a small weight on
// the acceleration of the links makes them converge, and is taken back from what they came to.
#pragma once

#include <memory>

#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// The problem with such a weight; null where it has one, or needs none: because its objective is curved in the torques,
// is time or a reward, or because there is no time to swing.
std::shared_ptr<const Problem> calmed(const Problem& problem);

// Where the best motion was found with that weight: solves again with less and less of it, as long as certified and
// better motions come of it.
void take_calm_back(Findings& found, Session& session);

}  // namespace fjr
