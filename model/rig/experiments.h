// Simulates the experiments of section IV of the paper on the virtual rig. A new one is a function in a file of its
// own, a member of Experiments with its settings, and its line in visit_experiments; the commands and rig.yaml go by
// that list.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/rig/record.h"
#include "model/rig/rig.h"

namespace fjr {

// Called now and then with the fraction that is done, unless the experiment is over soon. If it returns false, the
// experiment is aborted by std::runtime_error.
using RigProgress = std::function<bool(double fraction)>;

// Staircase 0 -> +n -> 0 -> -n -> 0 steps of one motor, 50 Hz: within `move` to the next step, then at rest.
struct Staircase {
  int steps;                // n
  double step;              // [rad]
  double period = 10;       // [s]
  double move = 0.1;        // [s]
  double average = 2;       // [s]  at the end of each period; written to the log for its evaluation
  double sample_rate = 50;  // [Hz]
  bool gravity = true;      // has no effect if both links are fixed, because their clamps carry it

  bool operator==(const Staircase&) const = default;
  static Staircase of_stiffness(int joint) { return {joint == 0 ? 82 : 48, 4.7124e-3}; }
  static Staircase of_gravity(int joint) { return {155, joint == 0 ? 7.8540e-3 : 9.4248e-3}; }
};

// joint: 0 or 1, here and below.
// IV-A: both links fixed.
Record perform_stiffness(const Rig& rig, int joint, const Staircase& staircase, const RigProgress& progress = {});
// IV-B: the other link fixed at zero.
Record perform_gravity(const Rig& rig, int joint, const Staircase& staircase, const RigProgress& progress = {});

// IV-C: arm parallel to the ground, motors held at zero, the other link fixed; a push of 10 ms sets the link swinging.
struct Impulse {
  double amplitude;  // [rad]  of the swing without damping
  double duration;   // [s]
  double sample_rate = 1000;
  bool gravity = false;

  bool operator==(const Impulse&) const = default;
  static Impulse of(int joint) { return {joint == 0 ? 0.33 : 0.20, 6}; }
};
Record perform_link_inertia(const Rig& rig, int joint, const Impulse& impulse, const RigProgress& progress = {});

// IV-E: link removed, velocity mode; each speed in both directions, one after the other.
struct ConstantSpeeds {
  std::vector<double> speeds;     // [rad/s], positive
  double ramp = 0.1, hold = 0.5;  // [s]
  double sample_rate = 1000;

  bool operator==(const ConstantSpeeds&) const = default;
  // Returns the speeds that a real rig can hold. `slow` adds those at which the kinks of (24) are, which only an ideal
  // drive can hold.
  static ConstantSpeeds of(int joint, bool slow);
};
Record perform_motor_friction(const Rig& rig, int joint, const ConstantSpeeds& speeds,
                              const RigProgress& progress = {});

// IV-F: link removed, torque mode, nonlinear friction compensated from the drive's own velocity (26); each constant
// torque u in both directions from standstill. The log's column u<joint>_plan is u.
struct ConstantTorques {
  std::vector<double> torques;  // u [N m], positive
  double rest = 0.2, push;      // [s]
  double sample_rate = 1000;

  bool operator==(const ConstantTorques&) const = default;
  static ConstantTorques of(int joint) {
    return joint == 0 ? ConstantTorques{{1, 1.5, 2, 2.5, 3}, 0.2, 0.8}
                      : ConstantTorques{{1, 1.75, 2.5, 3.25, 4}, 0.2, 0.2};
  }
};
Record perform_motor_inertia(const Rig& rig, int joint, const ConstantTorques& torques,
                             const RigProgress& progress = {});

// The settings of all experiments for both joints.
struct Experiments {
  Joints<Staircase> stiffness{Staircase::of_stiffness(0), Staircase::of_stiffness(1)};
  Joints<Staircase> gravity{Staircase::of_gravity(0), Staircase::of_gravity(1)};
  Joints<Impulse> link_inertia{Impulse::of(0), Impulse::of(1)};
  Joints<ConstantSpeeds> motor_friction;
  Joints<ConstantTorques> motor_inertia{ConstantTorques::of(0), ConstantTorques::of(1)};

  bool operator==(const Experiments&) const = default;
  // slow: see ConstantSpeeds.
  static Experiments of_paper(bool slow) {
    Experiments all;
    all.motor_friction = {ConstantSpeeds::of(0, slow), ConstantSpeeds::of(1, slow)};
    return all;
  }
};

struct ExperimentInfo {
  const char* name;            // of the key in rig.yaml and of the procedure too
  bool clamped_links = false;  // both, whose clamps carry gravity: rig.yaml says nothing of that
};

// Calls visit(ExperimentInfo, settings, the function that performs it) for each, in the order of section IV.
template <class E, class Visit>
void visit_experiments(E& experiments, Visit&& visit) {
  visit(ExperimentInfo{.name = "stiffness", .clamped_links = true}, experiments.stiffness, perform_stiffness);
  visit(ExperimentInfo{.name = "gravity"}, experiments.gravity, perform_gravity);
  visit(ExperimentInfo{.name = "link_inertia"}, experiments.link_inertia, perform_link_inertia);
  visit(ExperimentInfo{.name = "motor_friction"}, experiments.motor_friction, perform_motor_friction);
  visit(ExperimentInfo{.name = "motor_inertia"}, experiments.motor_inertia, perform_motor_inertia);
}

// The names of all experiments: "stiffness", ...
std::vector<std::string> experiment_names();

// Performs the experiment with this name.
Record perform(const std::string& name, const Rig& rig, int joint, const Experiments& experiments,
               const RigProgress& progress = {});

}  // namespace fjr
