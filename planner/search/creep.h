// Motors whose rest is unstable, because their friction falls with speed there, are kept moving.
#pragma once

#include <vector>

#include "planner/problem/problem.h"
#include "planner/search/settings.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// A motor whose friction falls with speed near standstill (FrictionLaw::unstable_band) cannot rest there: the
// certificate's closed loop, which has no dither, does not hold it to a count, and it keeps drifting off and back. A
// little faster than the band it is stable, and ends a long wait only a few milliradians further. Returns the least
// velocity [rad/s] of each motor in each interval, with its sign; 0 where none is asked for. The first and the last
// interval are left free for leaving the start and stopping at the goal.
std::vector<Joints<double>> creep_through_rests(const Problem& problem, const Motion& motion,
                                                const CreepSettings& settings);

}  // namespace fjr
