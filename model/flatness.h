// Differential flatness: q and its first four time derivatives determine the whole state and the torque.
#pragma once

#include "model/dynamics.h"

namespace fjr {

// q and its derivatives at one instant; [rad, rad/s, ...]
struct LinkMotion {
  Joints<double> q{}, dq{}, ddq{}, dddq{}, ddddq{};
};

struct FlatPoint {
  State<double> state;
  Joints<double> compensated_torque;  // u = J ddtheta + B dtheta + tau_c  [N m]
  Joints<double> torque;              // tau_m = u + tau_fm_nonlinear(dtheta), exact law  [N m]
};

// Computes state and torque from a link motion. theta, dtheta and ddtheta follow from the link side of (1) and its
// first two time derivatives, which are computed exactly by propagating truncated Taylor series through the link
// equation.
FlatPoint from_link_motion(const Parameters& p, const LinkMotion& motion);

// The inverse: returns the link motion in a state under the friction-compensated torque u [N m].
LinkMotion link_motion(const Parameters& p, const State<double>& state, const Joints<double>& u);

}  // namespace fjr
