// The true motion in an experiment, before it is measured by instruments.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/dynamics.h"
#include "model/log.h"
#include "model/rig/rig.h"

namespace fjr {

struct Record {
  std::map<std::string, std::string> metadata;
  std::vector<double> time;  // [s]
  std::vector<State<double>> states;
  std::vector<Joints<double>> torques;         // tau_m [N m]
  std::vector<Joints<double>> drive_velocity;  // as measured by the drive; empty if it did not affect the motion
  bool log_velocity = false;                   // write the drive's velocity to the log
  std::map<std::string, std::vector<double>> planned;  // further columns, by name

  void add(double t, const State<double>& x, const Joints<double>& tau) {
    time.push_back(t);
    states.push_back(x);
    torques.push_back(tau);
  }
};

// Returns the log as measured by the instruments of `rig`. The position of zero within an encoder count is random,
// drawn from the seed like the noise.
Log measure(const Record& record, const Rig& rig);

}  // namespace fjr
