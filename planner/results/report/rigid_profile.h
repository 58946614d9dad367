// What planning without the springs would have done: the textbook's profiles for a rigid arm, run on the elastic one.
#pragma once

#include <string>
#include <vector>

#include "model/dynamics.h"
#include "planner/certificate/run_figures.h"
#include "planner/certificate/simulation.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

enum class Profile {
  kMinimumJerk,  // s = 10 c^3 - 15 c^4 + 6 c^5
  kTrapezoidal,  // of velocity: a third of the time each to speed up, to cruise and to brake
};

const char* name(Profile profile);

// How far along the way at fraction c of the time, 0 to 1, and its derivatives with respect to c. Where the trapezoid's
// acceleration jumps, at 1/3 and 2/3, it is the later one.
struct Along {
  double position = 0, velocity = 0, acceleration = 0;
};
Along along(Profile profile, double c);

// What a controller that takes the arm for rigid commands between two rests: link and motor positions go straight from
// one rest to the other, all along the profile; torque is the inverse dynamics of the rigid arm (links and motors as
// one body per joint) with gravity and the exact friction law. At both ends motors and torque are those of the true
// rest, springs included, so that nothing but the elasticity on the way is left out. Torque jumps with the trapezoid's
// acceleration. duration [s] > 0.
Trajectory rigid_reference(const Parameters& p, Profile profile, const Joints<double>& from, const Joints<double>& to,
                           double duration);

inline constexpr double kWatchedAfterEnd = 1;  // [s]
inline constexpr double kSettled = 1e-3;       // [rad] ten counts of the link encoder

// One run on the exact elastic model, to kWatchedAfterEnd after the end. What the drive would have to give is not
// bounded.
struct ElasticRun {
  Simulation simulation;
  RunFigures figures;  // settled: within kSettled
};

// Follows `reference` in closed loop, then holds the rest at its last row. `reference` starts at rest.
ElasticRun run_on_elastic_arm(const Parameters& p, const Trajectory& reference);

}  // namespace fjr
