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

// If only torque is penalised and there is time to spare, the best motion takes a second or two, and for the rest of
// the time the arm rests where friction holds it without torque. With smoothed friction a rest takes torque, and so
// much over a long one that the usual search is led to other motions, of up to seven times the effort
// (bench/README.md). Therefore a shorter motion is looked for, in which a rest hardly counts; then the wait is put in,
// and the motion is solved again with exact friction.
//
// The arm waits at the start or at the goal if friction holds it there. Otherwise it pauses on the way, where friction
// holds it (Pause). starts: their number, as for find_motions(). If the plan is enough, `found` tells what was
// searched.
WithWait plan_with_wait(int starts, Findings& found, Session& session);

}  // namespace fjr
