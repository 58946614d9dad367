// Where there is time to spare, objectives that are not curved in the torques leave oscillations of the springs and the
// motors undetermined, and optima have some that are finer than any mesh or rows. Small weights of other terms remove
// them; a plan is judged by the objective that was asked for.
#pragma once

#include <memory>
#include <vector>

#include "planner/search/findings.h"
#include "planner/search/session.h"

namespace fjr {

// A fastest motion of many seconds, all of which a speed limit keeps: with such weights, in the order in which they are
// tried until one is certified.
std::vector<std::shared_ptr<const Problem>> calmed_hurry(const Problem& problem);

// The problem of another objective with a weight on the acceleration of the links; null where it has one, or needs
// none: because its objective is curved in the torques, is time or a reward, or because there is no time to swing.
std::shared_ptr<const Problem> calmed(const Problem& problem);

// Where the best motion was found with that weight: solves again with less and less of it, as long as certified and
// better motions come of it.
void take_calm_back(Findings& found, Session& session);

}  // namespace fjr
