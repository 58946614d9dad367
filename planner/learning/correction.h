// Computes from one run of a motion how to correct its torques so that the links follow the plan in the next run.
#pragma once

#include <optional>
#include <vector>

#include "planner/learning/smoothed_run.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// A correction to be added to the executed samples, at `times` [s]. Between them torque is linear and theta cubic, as
// in a trajectory.
struct Correction {
  std::vector<double> times;
  std::vector<Joints<double>> torque;         // [N m] feed-forward
  std::vector<Joints<double>> theta, dtheta;  // [rad], [rad/s] of the motors' reference
  State<double> start{};                      // expected state of the arm at the start of the next run
};

// Norm-optimal iterative learning control (Amann, Owens & Rogers, IEE Proc. Control Theory Appl. 143, 1996). It
// minimises over all changes of the torque since the last run the sum of the squared link errors expected in the next
// run, and the squared increments of the change from tick to tick. The prediction is the model, linearised along the
// last run, and the minimisation a Riccati recursion over the ticks. The reference of the motors is set to their
// expected positions. The next run is expected to begin at rest. Each motor is expected where it began in the last run,
// if that is within two counts of where its reference began, or of where the run before began (then another motion of a
// repeated sequence leaves it there). Otherwise it is expected at its reference. If the links then begin off the plan,
// they are led to it within 0.3 s, or half of the motion. executed: the samples that the run was commanded;
// began_before: motor positions [rad] at the start of the run before it.
Correction correction_after(const Parameters& robot, const Trajectory& executed, const SmoothedRun& run,
                            const std::optional<Joints<double>>& began_before = {});

// Returns the samples with the given fraction (0 to 1) of the correction added, and with additional samples at its
// times. Positions and velocities of the links stay those of the plan.
Trajectory corrected(const Trajectory& executed, const Correction& correction, double fraction = 1);

}  // namespace fjr
