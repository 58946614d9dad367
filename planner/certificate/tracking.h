// Predicts what the executor's control law does on the hardware.
#pragma once

#include "planner/certificate/certificate.h"
#include "planner/control/motor_feedback.h"

namespace fjr {

// Counts of the link encoder that are added to a link's error, because runs start elsewhere than at the first row,
// within rest_error() and anywhere in the counts of the motors. In 16 runs of eight plans from where the executor had
// brought the arm to rest it was at most 1.9 counts.
inline constexpr int kRestCounts = 3;

// Runs the trajectory on the simulated arm under the TickController, torque held over every tick, from its first row;
// link_error with kRestCounts on top.
Tracking predict_tracking(const Parameters& p, const Trajectory& trajectory);

}  // namespace fjr
