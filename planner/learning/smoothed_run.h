// Estimates the states of an arm in an executed motion, and the torques that the model lacks to explain them.
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

  // Returns the lacking torques in the tick that contains `time` [s], clamped to the first and the last tick.
  LackingTorques lacking_at(double time) const;
};

// Returns the most likely motion given all readings, with the lacking torques modelled as random walks and quantisation
// as measurement noise. It uses an extended Kalman filter and the Bryson-Frazier smoother in Bierman's form (Fixed
// interval smoothing with discrete measurements, Int. J. Control 18, 1973), which inverts only the innovations'
// covariance. Throws InputError naming the log if the arm cannot be simulated under its torques.
SmoothedRun smoothed_run(const Parameters& robot, const ExecutedMotion& motion);

}  // namespace fjr
