// fjr experiment design: motions of the arm from which its parameters can be identified.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fjr {

struct ExperimentDesignArguments {
  std::string robot;          // empty: the robot.yaml shipped with fjr
  std::string out;            // folder, which must be empty if it exists
  std::vector<double> start;  // [rad] empty: straight down
  double duration = 20;       // [s]
  int candidates = 16;
  double widen = 1;  // times the standard errors of the robot file
  bool payload_known = false;
  std::uint64_t seed = 1;
  bool json = false;
};

// Writes a request for each motion, 01.yaml and so on, and then design.json with the accuracy that they will give.
// Returns the exit code.
int experiment_design(const ExperimentDesignArguments& arguments);

}  // namespace fjr
