// The link side of the flexible-joint arm, eq. (1) of the paper, for any scalar type: M(q), C(q,dq) dq, G(q), and the
// acceleration under the springs' torque.
#pragma once

#include <cmath>
#include <cstddef>

#include "model/parameters.h"

namespace fjr {

inline constexpr int kStates = 8;
inline constexpr int kControls = 2;
// Index of the first entry of each part of the state.
inline constexpr int kStateQ = 0, kStateDq = kJoints, kStateTheta = 2 * kJoints, kStateDtheta = 3 * kJoints;

// Order of the state everywhere (vectors, files, messages): q, dq, theta, dtheta; [rad], [rad/s].
template <class T>
struct State {
  Joints<T> q, dq, theta, dtheta;

  // Gives access to the entries in this order by index.
  T& operator[](std::size_t i) { return part(*this, i / kJoints)[i % kJoints]; }
  const T& operator[](std::size_t i) const { return part(*this, i / kJoints)[i % kJoints]; }

  template <class From>
  static State from(const From* x) {
    State s;
    for (std::size_t i = 0; i < kStates; ++i) s[i] = x[i];
    return s;
  }
  template <class To>
  void copy_to(To* x) const {
    for (std::size_t i = 0; i < kStates; ++i) x[i] = (*this)[i];
  }

 private:
  template <class S>
  static auto& part(S& s, std::size_t k) {
    switch (k) {
      case kStateQ / kJoints:
        return s.q;
      case kStateDq / kJoints:
        return s.dq;
      case kStateTheta / kJoints:
        return s.theta;
      default:
        return s.dtheta;
    }
  }
};

// Mass matrix (23), symmetric. [kg m^2]
template <class T>
struct MassMatrix {
  T m11, m12, m22;
};

// Returns (alpha2 m2 + payload) l1 l2 [kg m^2], the inertial coupling between the links.
inline double coupling(const Parameters& p) {
  return (p.link.com_fraction[1] * p.link.mass[1] + p.payload.mass) * p.link.length[0] * p.link.length[1];
}

// Returns the coefficients [N m] of sin(q1 - down) and sin(q1 + q2 - down) in G, eq. (8), including the payload and the
// inclination of the plane.
inline constexpr double kPaperGravity = 9.8;  // [m/s^2] the value with which (6) and (7) give the alphas in the paper
inline Joints<double> gravity_coefficients(const Parameters& p) {
  const double weight = p.payload.mass * kPaperGravity;
  const double in_plane = p.mounting.gravity;
  return {in_plane * (p.link.gravity_torque[0] + weight * p.link.length[0]),
          in_plane * (p.link.gravity_torque[1] + weight * p.link.length[1])};
}

// Returns the robot with an additional payload at its tip.
inline Parameters with_payload(Parameters robot, const Payload& more) {
  robot.payload.mass += more.mass;
  robot.payload.inertia += more.inertia;
  return robot;
}

// Returns M(q) [kg m^2], eq. (23), with the payload. It depends only on the angle of joint 2 [rad].
template <class T>
MassMatrix<T> mass_matrix(const Parameters& p, const T& q2) {
  using std::cos;
  const double l1 = p.link.length[0], l2 = p.link.length[1], r2 = p.link.com_fraction[1] * l2, m2 = p.link.mass[1];
  const double about_joint2 = p.link.inertia[1] + m2 * r2 * r2 + p.payload.inertia + p.payload.mass * l2 * l2;
  const T coupled = coupling(p) * cos(q2);
  return {p.link.inertia[0] + about_joint2 + (m2 + p.payload.mass) * l1 * l1 + 2.0 * coupled, about_joint2 + coupled,
          T(about_joint2)};
}

// Returns C(q,dq) dq [N m]. The paper prints C12 = -a dq1 sin q2 in (23). The Lagrangian (19)-(21) gives C12 = -a dq2
// sin q2, which is used here, because only that conserves energy.
template <class T>
Joints<T> coriolis_torque(const Parameters& p, const Joints<T>& q, const Joints<T>& dq) {
  using std::sin;
  const T a = coupling(p) * sin(q[1]);
  return {-a * dq[1] * (2.0 * dq[0] + dq[1]), a * dq[0] * dq[0]};
}

// Returns G(q) [N m], eq. (8).
template <class T>
Joints<T> gravity_torque(const Parameters& p, const Joints<T>& q) {
  using std::sin;
  const Joints<double> coefficient = gravity_coefficients(p);
  const T first = q[0] - p.mounting.down;  // from where gravity pulls
  const T second = coefficient[1] * sin(first + q[1]);
  return {coefficient[0] * sin(first) + second, second};
}

// Returns tau_c = K (theta - q) [N m].
template <class T>
Joints<T> spring_torque(const Parameters& p, const Joints<T>& q, const Joints<T>& theta) {
  return {p.spring.stiffness[0] * (theta[0] - q[0]), p.spring.stiffness[1] * (theta[1] - q[1])};
}

// Returns M^-1 r [rad/s^2] for torques r [N m].
template <class T, class R>
Joints<T> accelerations(const MassMatrix<T>& m, const R& r1, const R& r2) {
  const T inverse_determinant = 1.0 / (m.m11 * m.m22 - m.m12 * m.m12);
  return {(m.m22 * r1 - m.m12 * r2) * inverse_determinant, (m.m11 * r2 - m.m12 * r1) * inverse_determinant};
}

// Returns ddq [rad/s^2] of the link side under the spring torque tau_c [N m].
template <class T>
Joints<T> link_acceleration(const Parameters& p, const Joints<T>& q, const Joints<T>& dq, const Joints<T>& tau_c) {
  const MassMatrix<T> m = mass_matrix(p, q[1]);
  const Joints<T> c = coriolis_torque(p, q, dq);
  const Joints<T> g = gravity_torque(p, q);
  const T r1 = tau_c[0] - c[0] - g[0] - p.link.damping[0] * dq[0];
  const T r2 = tau_c[1] - c[1] - g[1] - p.link.damping[1] * dq[1];
  return accelerations(m, r1, r2);
}

}  // namespace fjr
