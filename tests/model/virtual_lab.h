// Logs of the virtual rig for the identification's tests.
#pragma once

#include <string>
#include <vector>

#include "model/identify/arm.h"
#include "model/identify/procedures.h"
#include "model/rig/experiments.h"

namespace fjr {

// The shipped robot with the alphas that (6) and (7) give without the paper's rounding to four digits.
inline Parameters consistent_robot() {
  Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  const Parameters::Link& l = p.link;
  p.link.com_fraction = {(l.gravity_torque[0] / (kPaperGravity * l.length[0]) - l.mass[1]) / l.mass[0],
                         l.gravity_torque[1] / (kPaperGravity * l.mass[1] * l.length[1])};
  return p;
}

inline double parameter(const Parameters& p, const std::string& wanted) {
  double found = 0;
  visit_parameters(p,
                   [&](const std::string& section, const std::string& name, const char*, const Joints<double>& value) {
                     for (std::size_t j = 0; j < kJoints; ++j) {
                       if (section + "." + name + "[" + std::to_string(j) + "]" == wanted) found = value[j];
                     }
                   });
  return found;
}

struct NamedRecord {
  std::string name;
  int joint;
  Record record;
};

// Every experiment on both joints, with shorter staircases than the paper's.
inline std::vector<NamedRecord> short_experiments(const Rig& rig, bool slow_speeds) {
  std::vector<NamedRecord> all;
  for (int joint = 0; joint < kJoints; ++joint) {
    Staircase stiffness{30, joint == 0 ? 0.3864 / 30 : 0.2262 / 30};
    stiffness.period = 1;
    stiffness.average = 0.8;
    all.push_back({"stiffness", joint, perform_stiffness(rig, joint, stiffness)});
    all.push_back({"gravity", joint, perform_gravity(rig, joint, {20, joint == 0 ? 1.2174 / 20 : 1.4608 / 20})});
    all.push_back({"link_inertia", joint, perform_link_inertia(rig, joint, Impulse::of(joint))});
    all.push_back(
        {"motor_friction", joint, perform_motor_friction(rig, joint, ConstantSpeeds::of(joint, slow_speeds))});
    all.push_back({"motor_inertia", joint, perform_motor_inertia(rig, joint, ConstantTorques::of(joint))});
  }
  return all;
}

}  // namespace fjr
