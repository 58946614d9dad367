// What an arm did in an executed motion, and which torques its model lacks for that.
#pragma once

#include <string>
#include <vector>

#include "planner/identify/executed_motion.h"
#include "planner/learning/tick_slopes.h"

namespace fjr {

struct SmoothedRun {
  std::string log;  // the file, for messages
  // Of each tick:
  std::vector<double> times;            // [s]
  std::vector<State<double>> states;    // of the arm, at that time
  std::vector<Joints<double>> torque;   // [N m] commanded from then to the next
  std::vector<LackingTorques> lacking;  // from then to the next

  // In the tick that `time` [s] is in; before the first and after the last, theirs.
  LackingTorques lacking_at(double time) const;
};

// The most likely motion given all readings, where the lacking torques are random walks: an extended Kalman filter, and
// backwards the smoother of Bryson & Frazier as Bierman has it (Fixed interval smoothing with discrete measurements,
// Int. J. Control 18, 1973), which inverts nothing but the innovations' covariance. Readings are off by what their
// counts make. Throws InputError naming the log where the arm cannot be rolled out under its torques.
SmoothedRun smoothed_run(const Parameters& robot, const ExecutedMotion& motion);

}  // namespace fjr
