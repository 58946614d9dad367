#include "model/flatness.h"

#include "common/taylor.h"

namespace fjr {
namespace {

// The spring torque and its first two time derivatives, which determine theta, dtheta and ddtheta.
using Expansion = Taylor<2>;

Joints<Expansion> series_of(const Joints<double>& value, const Joints<double>& first, const Joints<double>& second) {
  return {Expansion::from_derivatives({value[0], first[0], second[0]}),
          Expansion::from_derivatives({value[1], first[1], second[1]})};
}

// Solves the link side of (1) for tau_c.
Joints<Expansion> required_spring_torque(const Parameters& p, const LinkMotion& motion) {
  const Joints<Expansion> q = series_of(motion.q, motion.dq, motion.ddq);
  const Joints<Expansion> dq = series_of(motion.dq, motion.ddq, motion.dddq);
  const Joints<Expansion> ddq = series_of(motion.ddq, motion.dddq, motion.ddddq);
  const MassMatrix<Expansion> m = mass_matrix(p, q[1]);
  const Joints<Expansion> c = coriolis_torque(p, q, dq);
  const Joints<Expansion> g = gravity_torque(p, q);
  return {m.m11 * ddq[0] + m.m12 * ddq[1] + c[0] + p.link.damping[0] * dq[0] + g[0],
          m.m12 * ddq[0] + m.m22 * ddq[1] + c[1] + p.link.damping[1] * dq[1] + g[1]};
}

}  // namespace

FlatPoint from_link_motion(const Parameters& p, const LinkMotion& motion) {
  const Joints<Expansion> tau_c = required_spring_torque(p, motion);
  FlatPoint point;
  point.state.q = motion.q;
  point.state.dq = motion.dq;
  for (int joint = 0; joint < kJoints; ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    const double stiffness = p.spring.stiffness[j];
    point.state.theta[j] = motion.q[j] + tau_c[j].derivative(0) / stiffness;
    point.state.dtheta[j] = motion.dq[j] + tau_c[j].derivative(1) / stiffness;
    const double ddtheta = motion.ddq[j] + tau_c[j].derivative(2) / stiffness;
    point.compensated_torque[j] =
        p.motor.inertia[j] * ddtheta + p.friction.viscous[j] * point.state.dtheta[j] + tau_c[j].derivative(0);
    point.torque[j] = point.compensated_torque[j] + FrictionLaw::of(p, joint).nonlinear(point.state.dtheta[j]);
  }
  return point;
}

// The k-th derivative of the spring torque is M times the (2+k)-th derivative of q, plus terms with lower derivatives
// of q. Therefore the derivatives of q follow one after the other from theta and its derivatives.
LinkMotion link_motion(const Parameters& p, const State<double>& state, const Joints<double>& u) {
  const MassMatrix<double> m = mass_matrix(p, state.q[1]);
  const double determinant = m.m11 * m.m22 - m.m12 * m.m12;
  LinkMotion motion{state.q, state.dq, {}, {}, {}};
  const auto solve = [&](std::size_t derivative, const Joints<double>& spring_torque) {
    const Joints<Expansion> lower = required_spring_torque(p, motion);
    const double first = spring_torque[0] - lower[0].derivative(derivative);
    const double second = spring_torque[1] - lower[1].derivative(derivative);
    return Joints<double>{(m.m22 * first - m.m12 * second) / determinant,
                          (m.m11 * second - m.m12 * first) / determinant};
  };
  const auto spring = [&](const Joints<double>& theta, const Joints<double>& q) {
    return Joints<double>{p.spring.stiffness[0] * (theta[0] - q[0]), p.spring.stiffness[1] * (theta[1] - q[1])};
  };
  const Joints<double> tau_c = spring(state.theta, state.q);
  motion.ddq = solve(0, tau_c);
  motion.dddq = solve(1, spring(state.dtheta, state.dq));
  Joints<double> ddtheta;
  for (std::size_t j = 0; j < kJoints; ++j) {
    ddtheta[j] = (u[j] - tau_c[j] - p.friction.viscous[j] * state.dtheta[j]) / p.motor.inertia[j];
  }
  motion.ddddq = solve(2, spring(ddtheta, motion.ddq));
  return motion;
}

}  // namespace fjr
