// Long motions of least torque are looked for as shorter ones, and a wait is put in for the rest of their time.
#pragma once

#include <optional>

#include "planner/search/findings.h"
#include "planner/search/publication.h"

namespace fjr {

// A certified plan of such a request, if one was found.
struct WithWait {
  std::optional<Publication> best = std::nullopt;
  // The wait is at the start or the goal and costs less than 1 %, so that nothing else need be tried.
  bool is_enough = false;
};

// Where only torque is paid for, an arm with time to spare rests where friction holds it, and moves in a second or two.
// With smoothed friction such a rest costs torque, all the more the longer it is. So the usual search is led to other
// motions, which took up to seven times the effort (bench/README.md). Therefore a motion of a short time is
// looked for, in which a rest hardly counts; then the wait is put in, and the motion is solved again with exact
// friction.
//
// The arm waits at the start or at the goal if friction holds it there. Otherwise it pauses on the way, where friction
// holds it (Pause). starts: their number, as for find_motions(). If the plan is enough, `found` tells what was
// searched.
WithWait plan_with_wait(int starts, Findings& found, Session& session);

}  // namespace fjr
