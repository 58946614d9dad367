// Textbook profiles for a rigid arm, executed on the elastic one, to show the benefit of planning with the springs.
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

// The position s (0 to 1) along the path at the fraction c of the time, and its derivatives by c. Where the
// acceleration of the trapezoid jumps, at 1/3 and 2/3, it is the later value.
struct Along {
  double position = 0, velocity = 0, acceleration = 0;
};
Along along(Profile profile, double c);

// Returns what a controller for a rigid arm would command between two rest states. Link and motor positions move on a
// straight line in joint space with the given profile; the torque is the inverse dynamics of the rigid arm (link and
// motor as one body per joint) with gravity and the exact friction law. At both ends motor positions and torque are
// those of the elastic arm at rest, so that only the elasticity during the motion is neglected. The torque jumps with
// the acceleration of the trapezoid. duration [s] > 0.
Trajectory rigid_reference(const Parameters& p, Profile profile, const Joints<double>& from, const Joints<double>& to,
                           double duration);

inline constexpr double kWatchedAfterEnd = 1;  // [s]
inline constexpr double kSettled = 1e-3;       // [rad] ten counts of the link encoder

// A run on the exact elastic model until kWatchedAfterEnd after the end of the motion. The drive torque is not limited.
struct ElasticRun {
  Simulation simulation;
  RunFigures figures;  // settled: within kSettled
};

// Follows `reference`, which starts at rest, in closed loop, and then holds its last sample.
ElasticRun run_on_elastic_arm(const Parameters& p, const Trajectory& reference);

}  // namespace fjr
