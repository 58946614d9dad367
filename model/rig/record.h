// What truly happened in an experiment, before any instrument looked at it.
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
  std::vector<Joints<double>> drive_velocity;  // as the drive measured it; empty: it played no part in the motion
  bool log_velocity = false;                   // write the drive's velocity to the log
  std::map<std::string, std::vector<double>> planned;  // further columns, by name

  void add(double t, const State<double>& x, const Joints<double>& tau) {
    time.push_back(t);
    states.push_back(x);
    torques.push_back(tau);
  }
};

// The log that the instruments of `rig` make of it. Encoders count from where they happen to stand: the place of zero
// within its count is drawn from the seed, like the noise.
Log measure(const Record& record, const Rig& rig);

}  // namespace fjr
