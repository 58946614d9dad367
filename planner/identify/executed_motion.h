// What the executor logged of one motion, as identification takes it.
#pragma once

#include <string>
#include <vector>

#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// Tick by tick, from the first row to the end of what was planned.
struct ExecutedMotion {
  std::string log, hash;                      // file and its SHA-256
  std::vector<double> times;                  // [s]
  std::vector<Joints<double>> q;              // [rad] of the links, as the encoders said at that time
  std::vector<Joints<double>> theta;          // [rad] of the motors
  std::vector<Joints<double>> torque;         // [N m] commanded from that time to the next
  std::vector<Joints<double>> planned_theta;  // [rad]
  Joints<double> link_error_rms{};            // [rad] of the encoders off the plan
};

// Throws InputError for what is no log of the executor's, and where what moved the arm is not what the log says: ticks
// missed for so long that the drives braked.
ExecutedMotion executed_motion(const Log& log);

}  // namespace fjr
