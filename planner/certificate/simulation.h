// A trajectory on an arm that need not be the one it was planned for.
#pragma once

#include <string>
#include <vector>

#include "planner/trajectory/trajectory.h"

namespace fjr {

enum class ControlMode {
  kOpenLoop,    // the planned torque alone
  kClosedLoop,  // with motor-side feedback on the exact state, as the certificate has it
  kExecutor,    // with the executor's law: encoder counts, torque held for 1 ms ticks, the drives' peak torque
};

struct Simulation {
  std::vector<Sample> samples;  // torque: as commanded, feedback included; of kExecutor the one held until the sample
  bool torque_held = false;     // until each sample, and not linear between them
  bool completed = false;
  std::string failure;  // why the integration broke down; empty when completed
};

// Rolls the trajectory out, with the accuracy of a certificate or, tick by tick, of a prediction. `planned_for` has the
// gains, encoders and drives, `arm` is the one that moves. The samples are what the certificate looks at, at most 0.25
// ms apart, or of kExecutor the ends of its ticks.
// hold: [s] for so long the arm is then held in the rest at the last row's q, by the executor's law (hold_at_rest) and
// with a sample at the end of each of its ticks; of learnt rows with the motors at the last row's theta. 0 in open
// loop.
Simulation simulate(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory,
                    ControlMode control, double hold = 0);

// Where a trajectory begins on that arm: in its first row's state, or where that is rest for the one that it was
// planned for, in the rest of the other. Of learnt rows the motors' place is kept, and the links hang from it.
State<double> start_on(const Parameters& planned_for, const Parameters& arm, const Trajectory& trajectory);

// That row of the trajectory is rest for the arm that it was planned for, or, in learnt rows, for the arm that they
// were learnt on: there is no velocity in it.
bool stands(const Parameters& planned_for, const Trajectory& trajectory, const Sample& row);

}  // namespace fjr
