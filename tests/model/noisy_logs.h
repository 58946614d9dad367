// Logs of the virtual rig with noise, and what is identified from them.
#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"
#include "tests/model/virtual_lab.h"

namespace fjr {

inline const std::string kRobot = FJR_SOURCE_DIR "/config/robot.yaml";

// Logs of one noisy lab, made once; another seed is another day, with other noise.
inline const Log& noisy_log(const std::string& name, int joint, std::uint64_t seed = 1) {
  static const Rig shipped = Rig::of(load_parameters(kRobot));
  static const std::vector<NamedRecord> records = short_experiments(shipped, false);
  static std::map<std::string, Log> logs;
  Rig rig = shipped;
  rig.seed = seed;
  for (const NamedRecord& r : records) {
    if (r.name == name && r.joint == joint) {
      return logs.try_emplace(name + std::to_string(joint) + std::to_string(seed), measure(r.record, rig))
          .first->second;
    }
  }
  throw std::logic_error("no log of " + name);
}

inline Estimate identify_quietly(const std::string& name, const Log& log, int joint) {
  return identify(name, log, joint, load_parameters(kRobot));
}

// By somebody who is 10 to 50 % wrong about everything that is to be found.
inline Parameters misled_robot() {
  std::mt19937_64 random(5);
  return wrong_by_half(load_parameters(kRobot), random);
}

inline Estimate identify_misled(const std::string& name, const Log& log, int joint) {
  return identify(name, log, joint, misled_robot());
}

inline std::string warnings_of(const Estimate& e) {
  std::string all;
  for (const std::string& warning : e.warnings) all += warning + "\n";
  return all;
}

inline Log scaled(Log log, const std::string& column, double factor) {
  for (double& value : log.column(column)) value *= factor;
  return log;
}

}  // namespace fjr
