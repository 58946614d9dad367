// First and second derivatives of the link acceleration in closed form. With dual numbers instead, the Hessian of an
// interval took a quarter more time (bench/README.md).
//
// With a = M^-1 r, r = tau_c - C dq - D dq - G, and subscripts for derivatives (only q2 moves M):
//   a_i  = M^-1 (r_i - M_i a),        a_ij = M^-1 (r_ij - M_i a_j - M_j a_i - M_ij a)
// Featherstone, Rigid Body Dynamics Algorithms, ch. 3, has the equation of motion; the rest is its differentiation.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "common/dual.h"
#include "model/link_dynamics.h"

namespace fjr {

// The acceleration depends only on the first six entries of a state: q, dq, theta.
inline constexpr std::size_t kLinkInputs = 3 * kJoints;
inline constexpr std::size_t kLinkPairs = kLinkInputs * (kLinkInputs + 1) / 2;

// ddq [rad/s^2] of each joint and its derivatives by these inputs. Second derivatives are packed by rows of the lower
// triangle, as in Dual2.
struct LinkDerivatives {
  Joints<double> value;
  Joints<std::array<double, kLinkInputs>> first;
  Joints<std::array<double, kLinkPairs>> second;
};

namespace link_derivatives {

enum Input : std::size_t { kQ1, kQ2, kDq1, kDq2, kTheta1, kTheta2 };
constexpr std::size_t pair(std::size_t high, std::size_t low) { return high * (high + 1) / 2 + low; }

// M^-1 at a posture.
struct InverseMass {
  double i11, i12, i22;

  static InverseMass of(const MassMatrix<double>& m) {
    const double inverse_determinant = 1 / (m.m11 * m.m22 - m.m12 * m.m12);
    return {m.m22 * inverse_determinant, -m.m12 * inverse_determinant, m.m11 * inverse_determinant};
  }
  Joints<double> times(double r1, double r2) const { return {i11 * r1 + i12 * r2, i12 * r1 + i22 * r2}; }
};

}  // namespace link_derivatives

// kSecond: whether second derivatives are computed; they are zero otherwise.
template <bool kSecond>
LinkDerivatives derivatives_of_link_acceleration(const Parameters& p, const Joints<double>& q, const Joints<double>& dq,
                                                 const Joints<double>& theta) {
  using namespace link_derivatives;
  const InverseMass inverse = InverseMass::of(mass_matrix(p, q[1]));
  const double a = coupling(p), bend = a * std::sin(q[1]), stretch = a * std::cos(q[1]);
  const Joints<double> gravity = gravity_coefficients(p);
  const double hanging = q[0] - p.mounting.down;
  const double g1_cos = gravity[0] * std::cos(hanging), g2_cos = gravity[1] * std::cos(hanging + q[1]);
  const double swirl = dq[1] * (2 * dq[0] + dq[1]), square = dq[0] * dq[0];
  const Joints<double>&k = p.spring.stiffness, &d = p.link.damping;

  LinkDerivatives of{link_acceleration(p, q, dq, spring_torque(p, q, theta)), {}, {}};
  const auto set = [&](auto& to, std::size_t at, const Joints<double>& value) {
    for (std::size_t j = 0; j < kJoints; ++j) to[j][at] = value[j];
  };
  // Returns -dM/dq2 times an acceleration. d2M/dq2^2 times it is the same with `stretch` instead of `bend`.
  const auto less_mass = [&](const Joints<double>& ddq) {
    return Joints<double>{bend * (2 * ddq[0] + ddq[1]), bend * ddq[0]};
  };
  const Joints<double> moved = less_mass(of.value);
  set(of.first, kQ1, inverse.times(-k[0] - g1_cos - g2_cos, -g2_cos));
  set(of.first, kQ2, inverse.times(stretch * swirl - g2_cos + moved[0], -stretch * square - k[1] - g2_cos + moved[1]));
  set(of.first, kDq1, inverse.times(2 * bend * dq[1] - d[0], -2 * bend * dq[0]));
  set(of.first, kDq2, inverse.times(2 * bend * (dq[0] + dq[1]), -d[1]));
  set(of.first, kTheta1, {inverse.i11 * k[0], inverse.i12 * k[0]});
  set(of.first, kTheta2, {inverse.i12 * k[1], inverse.i22 * k[1]});

  if constexpr (kSecond) {
    const double g1_sin = gravity[0] * std::sin(hanging), g2_sin = gravity[1] * std::sin(hanging + q[1]);
    const auto by = [&](std::size_t i) { return Joints<double>{of.first[0][i], of.first[1][i]}; };
    // With q2: r_ij - dM/dq2 a_i, solved.
    const auto with_q2 = [&](std::size_t i, double r1, double r2) {
      const Joints<double> less = less_mass(by(i));
      return inverse.times(r1 + less[0], r2 + less[1]);
    };
    set(of.second, pair(kQ1, kQ1), inverse.times(g1_sin + g2_sin, g2_sin));
    set(of.second, pair(kQ2, kQ1), with_q2(kQ1, g2_sin, g2_sin));
    const Joints<double> twice = less_mass(by(kQ2)), &ddq = of.value;
    set(of.second, pair(kQ2, kQ2),
        inverse.times(g2_sin - bend * swirl + 2 * twice[0] + stretch * (2 * ddq[0] + ddq[1]),
                      g2_sin + bend * square + 2 * twice[1] + stretch * ddq[0]));
    set(of.second, pair(kDq1, kQ2), with_q2(kDq1, 2 * stretch * dq[1], -2 * stretch * dq[0]));
    set(of.second, pair(kDq2, kQ2), with_q2(kDq2, 2 * stretch * (dq[0] + dq[1]), 0));
    set(of.second, pair(kTheta1, kQ2), with_q2(kTheta1, 0, 0));
    set(of.second, pair(kTheta2, kQ2), with_q2(kTheta2, 0, 0));
    set(of.second, pair(kDq1, kDq1), inverse.times(0, -2 * bend));
    set(of.second, pair(kDq2, kDq1), inverse.times(2 * bend, 0));
    set(of.second, pair(kDq2, kDq2), inverse.times(2 * bend, 0));
  }
  return of;
}

// Returns ddq [rad/s^2] of the link side in a state, under the torque of its springs.
template <class T>
Joints<T> link_acceleration(const Parameters& p, const State<T>& x) {
  return link_acceleration(p, x.q, x.dq, spring_torque(p, x.q, x.theta));
}

// Returns ddq with derivatives, by the chain rule from the closed-form derivatives by the six inputs.
template <CarriesValues D>
Joints<D> link_acceleration(const LinkDerivatives& of, const State<D>& x) {
  const std::array<const D*, kLinkInputs> inputs{&x.q[0], &x.q[1], &x.dq[0], &x.dq[1], &x.theta[0], &x.theta[1]};
  return {chain(inputs, of.value[0], of.first[0], of.second[0]), chain(inputs, of.value[1], of.first[1], of.second[1])};
}
template <class D>
requires CarriesValues<D> Joints<D> link_acceleration(const Parameters& p, const State<D>& x) {
  const auto values = [](const Joints<D>& of) { return Joints<double>{of[0].v, of[1].v}; };
  return link_acceleration(
      derivatives_of_link_acceleration<kHasSecond<D>>(p, values(x.q), values(x.dq), values(x.theta)), x);
}

}  // namespace fjr
