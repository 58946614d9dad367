// When and by which torque u of (26) a motor was pushed.
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

// By u<joint>_plan; where nobody commands, where tau - tau_fm_nonlinear(dtheta), with the friction known so far, is
// steady and not small.
std::vector<Push> pushes(const Log& log, int joint, const Parameters& robot);

// The torque itself plays no part where u is told; InputError for that of another joint, sign or unit, found by (26).
void require_consistent_torque(const Log& log, int joint, const Parameters& robot, const std::vector<Push>& found);

}  // namespace fjr
