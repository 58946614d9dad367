// The flexible-joint arm, eq. (1) of the paper, for any scalar type.
//
//   M(q) ddq + C(q,dq) dq + D dq + G(q) = tau_c,       tau_c = K (theta - q)
//   J ddtheta + tau_fm(dtheta) + tau_c  = tau_m
//
// q = 0 hangs straight down; motor quantities are in link coordinates. The payload at the tip is part of M, C and G.
#pragma once

#include <cmath>
#include <cstddef>

#include "model/friction.h"
#include "model/link_derivatives.h"
#include "model/link_dynamics.h"
#include "model/parameters.h"

namespace fjr {

// Returns dddq [rad/s^3] of the link side, from (1) differentiated once in time:
//   M dddq = K (dtheta - dq) - d(C dq)/dt - D ddq - dG/dt - dM/dt ddq.
template <class T>
Joints<T> link_jerk(const Parameters& p, const State<T>& x, const Joints<T>& ddq) {
  using std::cos;
  using std::sin;
  const T &dq1 = x.dq[0], &dq2 = x.dq[1];
  const T bend = coupling(p) * sin(x.q[1]), bend_rate = coupling(p) * cos(x.q[1]) * dq2;
  const Joints<double> gravity = gravity_coefficients(p);
  const T hanging = x.q[0] - p.mounting.down;
  const T both = dq1 + dq2, second = gravity[1] * cos(hanging + x.q[1]) * both;
  const T first = gravity[0] * cos(hanging) * dq1;
  const T mass_rate = -bend * dq2;  // dm12/dt; dm11/dt is twice that, dm22/dt is 0
  const T c1 = -bend_rate * dq2 * (dq1 + both) - bend * (ddq[1] * (dq1 + both) + dq2 * (2.0 * ddq[0] + ddq[1]));
  const T c2 = (bend_rate * dq1 + 2.0 * bend * ddq[0]) * dq1;
  const Joints<T> spring = spring_torque(p, x.dq, x.dtheta);  // rate of the spring torque, which is linear
  const T r1 = spring[0] - c1 - p.link.damping[0] * ddq[0] - first - second - mass_rate * (2.0 * ddq[0] + ddq[1]);
  const T r2 = spring[1] - c2 - p.link.damping[1] * ddq[1] - second - mass_rate * ddq[0];
  const MassMatrix<T> m = mass_matrix(p, x.q[1]);
  return accelerations(m, r1, r2);
}

// Returns dx/dt for the friction-compensated torque u = tau_m - tau_fm_nonlinear(dtheta) [N m], eq. (26): J ddtheta + B
// dtheta + tau_c = u. It is smooth for every finite x and u.
template <class T>
State<T> compensated_dynamics(const Parameters& p, const State<T>& x, const Joints<T>& u) {
  const Joints<T> tau_c = spring_torque(p, x.q, x.theta);
  State<T> f;
  f.q = x.dq;
  f.dq = link_acceleration(p, x);
  f.theta = x.dtheta;
  for (std::size_t j = 0; j < kJoints; ++j) {
    f.dtheta[j] = (u[j] - tau_c[j] - p.friction.viscous[j] * x.dtheta[j]) / p.motor.inertia[j];
  }
  return f;
}

// Returns dx/dt, eq. (1), with the exact friction law (24), for the motor torque tau_m [N m].
template <class T>
State<T> dynamics(const Parameters& p, const State<T>& x, const Joints<T>& tau_m) {
  Joints<T> u;
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    u[i] = tau_m[i] - FrictionLaw::of(p, j).nonlinear(x.dtheta[i]);
  }
  return compensated_dynamics(p, x, u);
}

// Returns the total energy [J]: kinetic energy (19) of links and motors, potential energy (21) of gravity and springs.
template <class T>
T energy(const Parameters& p, const State<T>& x) {
  using std::cos;
  const MassMatrix<T> m = mass_matrix(p, x.q[1]);
  T e = 0.5 * (m.m11 * x.dq[0] * x.dq[0] + 2.0 * m.m12 * x.dq[0] * x.dq[1] + m.m22 * x.dq[1] * x.dq[1]);
  const Joints<double> gravity = gravity_coefficients(p);
  const T hanging = x.q[0] - p.mounting.down;
  e += gravity[0] * (1.0 - cos(hanging)) + gravity[1] * (1.0 - cos(hanging + x.q[1]));
  for (std::size_t j = 0; j < kJoints; ++j) {
    const T deflection = x.theta[j] - x.q[j];
    e += 0.5 * (p.motor.inertia[j] * x.dtheta[j] * x.dtheta[j] + p.spring.stiffness[j] * deflection * deflection);
  }
  return e;
}

// Returns the equilibrium state at q: dq = dtheta = 0 and theta = q + K^-1 G(q), so that nothing moves under tau_m =
// G(q).
inline State<double> rest_at(const Parameters& p, const Joints<double>& q) {
  const Joints<double> g = gravity_torque(p, q);
  return {q, {0, 0}, {q[0] + g[0] / p.spring.stiffness[0], q[1] + g[1] / p.spring.stiffness[1]}, {0, 0}};
}

}  // namespace fjr
