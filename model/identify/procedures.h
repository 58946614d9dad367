// The identification procedures of section IV. Each takes the log of its experiment and returns the estimated
// parameters with their uncertainty. A new one is a function in a file of its own, and a function that draws its charts
// in another file, both declared here, and a line of procedures() in identify.cc; commands, reports, Python and whole
// identifications go by that list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/chart.h"
#include "model/identify/estimate.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

// The quantities from which the equations of arm.cc compute the parameters of the arm.
enum class ArmInput { kStiffness, kGravitySlope, kStiffnessOverInertia, kDampingOverInertia };

struct Procedure {
  std::string name;  // of its experiment too
  Estimate (*identify)(const Log& log, int joint, const Parameters& robot);
  std::vector<Chart> (*charts)(const Estimate& estimate);  // of an Estimate that identify() returned
  std::vector<ArmInput> arm_inputs;     // what the values of the estimate are, in their order; empty: none
  std::vector<std::string> parameters;  // "motor.inertia": parameters of the robot that the estimate gives directly
};

// The procedures in the order of section IV: a later one may need the results of an earlier one.
const std::vector<Procedure>& procedures();
const Procedure* find_procedure(std::string_view name);  // null if there is none of that name

// joint: 0 or 1. `robot`: parameters known so far, used for the encoder resolution and to detect wrong signs and units.
// All procedures throw InputError if the log cannot be from their experiment; what the log itself says of that, and of
// the joint, is checked by identify().

// IV-A: estimates K, the slope of the spring torque against theta - q, with the branches of the hysteresis separated.
Estimate identify_stiffness(const Log& log, int joint, const Parameters& robot);

// IV-B: estimates S, the slope of the torque at rest against sin q: (6) for joint 1, (7) for joint 2.
Estimate identify_gravity(const Log& log, int joint, const Parameters& robot);

// IV-C: estimates K/I and D/I of the free decay (9). The crests give a start by (10)-(14); then the whole curve is
// fitted.
Estimate identify_link_inertia(const Log& log, int joint, const Parameters& robot);

// IV-E: estimates the five parameters of (24).
Estimate identify_motor_friction(const Log& log, int joint, const Parameters& robot);

// IV-F: estimates J and B from the velocity responses (27) to the constant torques of column u<joint>_plan.
Estimate identify_motor_inertia(const Log& log, int joint, const Parameters& robot);

// The charts of each procedure: those of the paper, and the residuals.
std::vector<Chart> stiffness_charts(const Estimate& estimate);
std::vector<Chart> gravity_charts(const Estimate& estimate);
std::vector<Chart> link_inertia_charts(const Estimate& estimate);
std::vector<Chart> motor_friction_charts(const Estimate& estimate);
std::vector<Chart> motor_inertia_charts(const Estimate& estimate);

// Applies the procedure with this name. Throws InputError if the log says that it is of another experiment or joint.
Estimate identify(const std::string& name, const Log& log, int joint, const Parameters& robot);

}  // namespace fjr
