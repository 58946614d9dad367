// Motors whose rest is unstable, because their friction falls with speed there, are kept moving.
#pragma once

#include <vector>

#include "planner/problem/problem.h"
#include "planner/trajectory/motion.h"

namespace fjr {

// Where a motor whose friction falls with speed at rest (FrictionLaw::unstable_band) would rest, the certificate's
// closed loop, which has no dither, does not hold it there to a count: it wanders off and back for ever. Moving a
// little faster than the band it is stable, and a few milliradians further at the end of a long wait. Returns the
// velocity [rad/s] that each motor is to keep at least, with its sign, per interval; 0 where nothing is asked. Start
// and goal are left alone.
std::vector<Joints<double>> creep_through_rests(const Problem& problem, const Motion& motion);

}  // namespace fjr
