// The identification procedures of section IV: each takes the log of its experiment and gives what it tells, with
// doubt. A new one is a function in a file of its own, declared here, and a line of procedures() in identify.cc;
// commands, Python and whole identifications go by that list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/identify/estimate.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// What the equations of arm.cc make the arm's parameters of.
enum class ArmInput { kStiffness, kGravitySlope, kStiffnessOverInertia, kDampingOverInertia };

struct Procedure {
  std::string name;  // of its experiment too
  Estimate (*identify)(const Log& log, int joint, const Parameters& robot);
  std::vector<ArmInput> arm_inputs;     // what the estimate's values are, one after the other; empty: none
  std::vector<std::string> parameters;  // "motor.inertia": what the estimate's "inertia" is by itself
};

// In the order of section IV: what comes later may need what came before.
const std::vector<Procedure>& procedures();
const Procedure* find_procedure(std::string_view name);  // null where there is none of that name

// joint: 0 or 1. `robot`: what is known so far, for encoder resolution and to recognise wrong signs and units. All
// throw InputError for logs that cannot be what they are said to be.

// IV-A: K, the slope of the spring's torque against theta - q, hysteresis branches apart.
Estimate identify_stiffness(const Log& log, int joint, const Parameters& robot);

// IV-B: S, the slope of the torque at rest against sin q: (6) for joint 1, (7) for joint 2.
Estimate identify_gravity(const Log& log, int joint, const Parameters& robot);

// IV-C: K/I and D/I of the free decay (9). Peaks give a start by (10)-(14); the whole curve is then fitted.
Estimate identify_link_inertia(const Log& log, int joint, const Parameters& robot);

// IV-E: the five parameters of (24).
Estimate identify_motor_friction(const Log& log, int joint, const Parameters& robot);

// IV-F: J and B from the velocity responses (27) to the constant torques of column u<joint>_plan.
Estimate identify_motor_inertia(const Log& log, int joint, const Parameters& robot);

// By the procedure of that name. Throws InputError where the log says that it is of another experiment or joint.
Estimate identify(const std::string& name, const Log& log, int joint, const Parameters& robot);

}  // namespace fjr
