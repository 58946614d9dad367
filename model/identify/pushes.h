// Finds when a motor was pushed, and by which constant torque u of (26).
#pragma once

#include <vector>

#include "model/identify/row_ranges.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

struct Push {
  double u;  // [N m]
  RowRange rows;
};

// Returns the pushes according to u<joint>_plan. Without that column, they are the ranges in which tau -
// tau_fm_nonlinear(dtheta), with the friction known so far, is steady and not small.
std::vector<Push> pushes(const Log& log, int joint, const Parameters& robot);

// If u is logged, the torque is not used for the estimate. It is still checked by (26): throws InputError if it must be
// of another joint, sign or unit.
void require_consistent_torque(const Log& log, int joint, const Parameters& robot, const std::vector<Push>& found);

}  // namespace fjr
