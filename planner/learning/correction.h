// What a motion has to change for the arm to follow the links' plan, after one run of it.
#pragma once

#include <optional>
#include <vector>

#include "planner/learning/smoothed_run.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// On top of the rows that were executed, at `times` [s]; torque and dtheta are linear between them, theta is cubic.
struct Correction {
  std::vector<double> times;
  std::vector<Joints<double>> torque;         // [N m] feed-forward
  std::vector<Joints<double>> theta, dtheta;  // [rad], [rad/s] of the motors' reference
  State<double> start{};                      // of the arm in the next run, as it is expected
};

// Norm-optimal iterative learning control (Amann, Owens & Rogers, IEE Proc. Control Theory Appl. 143, 1996): of all
// changes of the torque since the last run, the one that is least in the sum of the squared errors of the links that
// the model, linearised along what the arm did, expects of the next run, and of the squared increments of the change
// from tick to tick. By a Riccati recursion over the ticks. The motors' reference is where they are expected.
// The next run is expected to begin at rest, each motor where it did in the last one, if that was within two counts of
// where its reference began, or of where the run before began: another motion of a repeated sequence leaves it there.
// Any other start was chance, and the next one is expected at the reference. Where the links then are off the plan,
// they go over to it within 0.3 s, or half of the motion.
// executed: the rows that the run was commanded; began_before: motors [rad] at the start of the run before it.
Correction correction_after(const Parameters& robot, const Trajectory& executed, const SmoothedRun& run,
                            const std::optional<Joints<double>>& began_before = {});

// The rows with so much of the correction, and with rows at its times. Positions and velocities of the links stay the
// plan's. fraction: 0 to 1.
Trajectory corrected(const Trajectory& executed, const Correction& correction, double fraction = 1);

}  // namespace fjr
