// Key figures of a simulated run.
#pragma once

#include "planner/certificate/simulation.h"
#include "planner/problem/quantities.h"

namespace fjr {

struct RunFigures {
  Joints<double> link_error{};    // [rad] of the links from the trajectory, largest until its end
  double effort = 0;              // [N^2 m^2 s] integral of the squared commanded torques until the end
  Limits peaks = Limits::all(0);  // largest magnitudes with the commanded torques, also after the end; no torque_rate
  Joints<double> residual{};      // [rad] largest |q - q_goal| from the end on
  // [s] after the end until both links stay within `settled` of the goal, for as long as they were watched; infinite:
  // they do not.
  double settling_time = 0;
};

// Returns the figures of a run of `trajectory` on `arm`. settled: [rad] distance from the goal at which a link counts
// as settled.
RunFigures figures_of(const Parameters& arm, const Trajectory& trajectory, const Simulation& run, double settled);

}  // namespace fjr
