// Statistics of an executed motion: errors, feedback torque, and how close it came to the limits.
#pragma once

#include "planner/problem/quantities.h"
#include "planner/protocol/execution_messages.h"

namespace fjr {

class Figures {
 public:
  struct Instant {
    State<double> measured;           // velocities filtered
    Joints<double> planned_q;         // [rad]
    Joints<double> torque, feedback;  // [N m]
    bool moving;                      // false: after the end
  };
  void add(const Parameters& robot, const Instant& now);

  // Fills the statistics into the result that is reported.
  void fill(ExecutionResult& result, const Parameters& robot) const;

 private:
  Joints<double> largest_{}, squares_{}, last_{}, residual_{}, feedback_{};
  Limits reached_ = Limits::all(0);  // of the quantities that robot.yaml limits
  long moving_ = 0;
};

}  // namespace fjr
