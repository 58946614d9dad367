#include "planner/stop/stop_limits.h"

namespace fjr {

Limits stop_limits(const Parameters& robot) {
  const Limits of_plan = Limits::of(robot);
  Limits limits = of_plan;
  for (const LimitName& name : kStopLimitNames) {
    const double planned = name.in(of_plan);
    const double of_drive = name.quantity->with_feedback_in(robot, of_plan, name.j());
    name.in(limits) = std::max(planned, 0.5 * (planned + of_drive)) * name.quantity->in_stop;
  }
  return limits;
}

}  // namespace fjr
