// The log of one executed motion in the form that identification uses.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// Values per tick, from the first row to the end of the plan.
struct ExecutedMotion {
  std::string log, hash;                      // file and its SHA-256
  std::vector<double> times;                  // [s]
  std::vector<Joints<double>> q;              // [rad] readings of the link encoders at that time
  std::vector<Joints<double>> theta;          // [rad] of the motors
  std::vector<Joints<double>> torque;         // [N m] commanded from that time to the next
  std::vector<Joints<double>> planned_theta;  // [rad]
  Joints<double> link_error_rms{};            // [rad] between link encoders and plan
};

// Throws InputError if the log is not one of the executor, or if the logged torques are not those that acted on the
// arm, because so many ticks were missed that the drives braked.
ExecutedMotion executed_motion(const Log& log);

}  // namespace fjr
