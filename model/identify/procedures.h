// The identification procedures of section IV: each takes the log of its experiment and gives what it tells, with
// doubt.
#pragma once

#include "model/identify/estimate.h"
#include "model/log.h"
#include "model/parameters.h"

namespace fjr {

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

// The procedure of that name.
Estimate identify(const std::string& name, const Log& log, int joint, const Parameters& robot);

}  // namespace fjr
