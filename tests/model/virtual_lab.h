// Logs of the virtual rig for the identification's tests.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "model/identify/arm.h"
#include "model/identify/procedures.h"
#include "model/rig/experiments.h"

namespace fjr {

// The alphas that (6) and (7) give.
inline void set_com_fraction(Parameters::Link& l) {
  l.com_fraction = {(l.gravity_torque[0] / (kPaperGravity * l.length[0]) - l.mass[1]) / l.mass[0],
                    l.gravity_torque[1] / (kPaperGravity * l.mass[1] * l.length[1])};
}

// The shipped robot without the paper's rounding of the alphas to four digits.
inline Parameters consistent_robot() {
  Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  set_com_fraction(p.link);
  return p;
}

inline std::vector<Joints<double>*> identified_parameters(Parameters& p) {
  return {&p.spring.stiffness, &p.link.gravity_torque,    &p.link.inertia,
          &p.motor.inertia,    &p.friction.viscous,       &p.friction.amplitude,
          &p.friction.width,   &p.friction.second_weight, &p.friction.second_shape};
}

// An arm of its own: everything that is identified up to a fifth away from the shipped one.
inline Parameters another_arm(std::mt19937_64& random) {
  Parameters p = consistent_robot();
  std::uniform_real_distribution<double> factor(0.8, 1.2);
  for (Joints<double>* value : identified_parameters(p)) {
    for (double& v : *value) v *= factor(random);
  }
  set_com_fraction(p.link);
  return p;
}

// What somebody believes who is 10 to 50 % wrong about everything that is identified.
inline Parameters wrong_by_half(const Parameters& truth, std::mt19937_64& random) {
  Parameters p = truth;
  std::uniform_real_distribution<double> factor(1.1, 1.5);
  for (Joints<double>* value : identified_parameters(p)) {
    for (double& v : *value) v *= random() % 2 == 0 ? factor(random) : 1 / factor(random);
  }
  set_com_fraction(p.link);
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
