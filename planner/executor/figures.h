// Statistics of an executed motion: errors, feedback torque, and how close it came to the limits.
#pragma once

#include "planner/problem/quantities.h"
#include "planner/protocol/execution_messages.h"

namespace fjr {

class Figures {
 public:
  struct Instant {
    Joints<double> q, dq, theta, dtheta;  // [rad], [rad/s] measured; velocities filtered
    Joints<double> planned_q;             // [rad]
    Joints<double> torque, feedback;      // [N m]
    bool moving;                          // false: after the end
  };
  void add(const Instant& now);

  // Fills the statistics into the result that is reported.
  void fill(ExecutionResult& result, const Parameters& robot) const;

 private:
  Joints<double> largest_{}, squares_{}, last_{}, residual_{}, feedback_{};
  Joints<double> torque_{}, motor_velocity_{}, deflection_{};
  Joints<double> lowest_{kNoLimit, kNoLimit}, highest_{-kNoLimit, -kNoLimit};  // [rad] of the links
  long moving_ = 0;
};

}  // namespace fjr
