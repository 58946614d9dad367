// What a simulated run amounts to.
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

// Of the run of `trajectory` on `arm`. settled: [rad] how near to the goal a link has come to rest.
RunFigures figures_of(const Parameters& arm, const Trajectory& trajectory, const Simulation& run, double settled);

}  // namespace fjr
