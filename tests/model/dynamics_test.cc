// The equations of motion against their own Lagrangian, written down a second time and differentiated mechanically.
#include "model/dynamics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/dual.h"
#include "model/flatness.h"
#include "tests/support/arbitrary.h"

namespace fjr {
namespace {

const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

// Nothing that takes energy away.
Parameters conservative() {
  Parameters p = robot();
  p.friction.amplitude = p.friction.viscous = p.link.damping = {0, 0};
  return p;
}

// Damped links as well, so that every term is there.
Parameters complete() {
  Parameters p = robot();
  p.link.damping = {0.2516, 0.013};
  return p;
}

// (19) with (20), term by term as printed.
template <class T>
T kinetic_energy_19(const Parameters& p, const T& q2, const T& dq1, const T& dq2) {
  using std::cos;
  const double l1 = p.link.length[0], l2 = p.link.length[1], alpha2 = p.link.com_fraction[1], m2 = p.link.mass[1];
  const T v2_squared = (l1 * l1 + alpha2 * alpha2 * l2 * l2 + 2 * alpha2 * l1 * l2 * cos(q2)) * dq1 * dq1 +
                       alpha2 * alpha2 * l2 * l2 * dq2 * dq2 +
                       (2 * alpha2 * alpha2 * l2 * l2 + 2 * alpha2 * l1 * l2 * cos(q2)) * dq1 * dq2;
  return 0.5 * p.link.inertia[0] * dq1 * dq1 + 0.5 * p.link.inertia[1] * (dq1 + dq2) * (dq1 + dq2) +
         0.5 * m2 * v2_squared;
}

// (21), with the coefficients of (8).
template <class T>
T potential_energy_21(const Parameters& p, const T& q1, const T& q2) {
  using std::cos;
  return p.link.gravity_torque[0] * (1.0 - cos(q1)) + p.link.gravity_torque[1] * (1.0 - cos(q1 + q2));
}

// d/dt (dK/d dq) - dK/dq = K_dq,dq ddq + K_dq,q dq - K_q, the derivatives of (19) taken by Dual2.
Joints<double> inertial_torque(const Parameters& p, const Joints<double>& q, const Joints<double>& dq,
                               const Joints<double>& ddq) {
  using D = Dual2<4>;  // q1, q2, dq1, dq2
  const D q2 = D::input(q[1], 1), dq1 = D::input(dq[0], 2), dq2 = D::input(dq[1], 3);
  const D k = kinetic_energy_19(p, q2, dq1, dq2);
  const auto hessian = [&k](std::size_t i, std::size_t j) { return k.second(i, j); };
  Joints<double> torque{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    torque[i] = -k.g[i];
    for (std::size_t j = 0; j < kJoints; ++j) torque[i] += hessian(2 + i, 2 + j) * ddq[j] + hessian(2 + i, j) * dq[j];
  }
  return torque;
}

// ---- the Lagrangian ----

// Sums of terms up to 100 N m, all of them smooth formulas without cancellation beyond their size: 1e-12 is 50
// roundings.
constexpr double kTorqueRounding = 1e-12;

RC_GTEST_PROP(Lagrangian, MassMatrixAndCoriolisTorqueFollowFromKineticEnergy, ()) {
  const Joints<double> q = pair_between(-3.2, 3.2), dq = pair_between(-8, 8), ddq = pair_between(-100, 100);
  const MassMatrix<double> m = mass_matrix(robot(), q[1]);
  const Joints<double> c = coriolis_torque(robot(), q, dq), expected = inertial_torque(robot(), q, dq, ddq);
  RC_ASSERT(std::abs(m.m11 * ddq[0] + m.m12 * ddq[1] + c[0] - expected[0]) < kTorqueRounding);
  RC_ASSERT(std::abs(m.m12 * ddq[0] + m.m22 * ddq[1] + c[1] - expected[1]) < kTorqueRounding);
}

RC_GTEST_PROP(Lagrangian, GravityIsTheGradientOfThePotential, ()) {
  const Joints<double> q = pair_between(-7, 7);
  const auto potential = potential_energy_21(robot(), Dual<2>::input(q[0], 0), Dual<2>::input(q[1], 1));
  const Joints<double> g = gravity_torque(robot(), q);
  RC_ASSERT(std::abs(g[0] - potential.g[0]) < 1e-14);  // two sines of at most 7 N m: a few roundings
  RC_ASSERT(std::abs(g[1] - potential.g[1]) < 1e-14);
}

RC_GTEST_PROP(Lagrangian, LinkAccelerationBalancesEveryTorque, ()) {
  const Parameters p = complete();
  const State<double> x = any_state();
  const Joints<double> tau_c = spring_torque(p, x.q, x.theta), g = gravity_torque(p, x.q);
  const Joints<double> inertial = inertial_torque(p, x.q, x.dq, link_acceleration(p, x.q, x.dq, tau_c));
  for (std::size_t j = 0; j < kJoints; ++j) {
    RC_ASSERT(std::abs(inertial[j] + p.link.damping[j] * x.dq[j] + g[j] - tau_c[j]) < kTorqueRounding);
  }
}

RC_GTEST_PROP(Lagrangian, EnergyIsThatOfThePaperPlusMotorsAndSprings, ()) {
  const State<double> x = any_state();
  double expected = kinetic_energy_19(robot(), x.q[1], x.dq[0], x.dq[1]) + potential_energy_21(robot(), x.q[0], x.q[1]);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double deflection = x.theta[j] - x.q[j];
    expected += robot().motor.inertia[j] * x.dtheta[j] * x.dtheta[j] / 2;
    expected += robot().spring.stiffness[j] * deflection * deflection / 2;
  }
  RC_ASSERT(std::abs(energy(robot(), x) - expected) < 1e-13);  // tens of joules: a few roundings
}

RC_GTEST_PROP(Lagrangian, MassMatrixIsPositiveDefinite, ()) {
  const MassMatrix<double> m = mass_matrix(robot(), between(-4, 4));
  RC_ASSERT(m.m11 > 0);
  RC_ASSERT(m.m11 * m.m22 - m.m12 * m.m12 > 0);
}

// The link's jerk, term by term from the equation differentiated once, against the Taylor series of flatness.
RC_GTEST_PROP(Lagrangian, LinkJerkIsTheRateOfTheAcceleration, ()) {
  Parameters p = complete();
  p.payload = {0.2, 0.001};
  const State<double> x = any_state();
  const LinkMotion motion = link_motion(p, x, {0, 0});
  const Joints<double> jerk = link_jerk(p, x, motion.ddq);
  for (std::size_t j = 0; j < kJoints; ++j) {
    RC_ASSERT(std::abs(jerk[j] - motion.dddq[j]) < 1e-10 * (1 + std::abs(motion.dddq[j])));
  }
}

// ---- payload ----

// The arm as bodies in the plane, written without the model's formulas: centres of mass and the payload as points whose
// velocities are differences of positions, inertias about their own centres.
struct Bodies {
  const Parameters& p;

  static Joints<double> towards(double angle, double length) {
    return {length * std::sin(angle), -length * std::cos(angle)};
  }
  static Joints<double> sum(const Joints<double>& a, const Joints<double>& b) { return {a[0] + b[0], a[1] + b[1]}; }
  Joints<double> elbow(const Joints<double>& q) const { return towards(q[0], p.link.length[0]); }
  Joints<double> centre2(const Joints<double>& q) const {
    return sum(elbow(q), towards(q[0] + q[1], p.link.com_fraction[1] * p.link.length[1]));
  }
  Joints<double> tip(const Joints<double>& q) const { return sum(elbow(q), towards(q[0] + q[1], p.link.length[1])); }

  template <class Place>
  double half_squared_speed(const Place& place, const Joints<double>& q, const Joints<double>& dq) const {
    constexpr double kStep = 1e-4;  // [s] of central differences, whose error is (0.1 rad/ms)^2 / 6 of the speed
    const auto at = [&](double t) { return place({q[0] + t * dq[0], q[1] + t * dq[1]}); };
    const Joints<double> after = at(kStep), before = at(-kStep);
    const double vx = (after[0] - before[0]) / (2 * kStep), vy = (after[1] - before[1]) / (2 * kStep);
    return 0.5 * (vx * vx + vy * vy);
  }
  double kinetic(const Joints<double>& q, const Joints<double>& dq) const {
    const double spin = dq[0] + dq[1];
    return 0.5 * p.link.inertia[0] * dq[0] * dq[0] +  // (18)'s M1: link 1 about its axis
           0.5 * (p.link.inertia[1] + p.payload.inertia) * spin * spin +
           p.link.mass[1] * half_squared_speed([this](const Joints<double>& at) { return centre2(at); }, q, dq) +
           p.payload.mass * half_squared_speed([this](const Joints<double>& at) { return tip(at); }, q, dq);
  }
  // Heights against hanging down; of the links by (8), whose coefficients are rounded.
  double potential(const Joints<double>& q) const {
    const double height = tip(q)[1] + p.link.length[0] + p.link.length[1];
    return p.link.gravity_torque[0] * (1 - std::cos(q[0])) + p.link.gravity_torque[1] * (1 - std::cos(q[0] + q[1])) +
           p.payload.mass * 9.8 * height;
  }
};

Parameters loaded(Parameters p) {
  p.payload = {0.4, 0.002};
  return p;
}

RC_GTEST_PROP(WithPayload, EnergyIsThatOfTheBodies, ()) {
  const Parameters p = loaded(robot());
  const Bodies bodies{p};
  State<double> x = any_state();
  x.theta = x.q;
  x.dtheta = {0, 0};  // neither springs nor motors
  const double expected = bodies.kinetic(x.q, x.dq) + bodies.potential(x.q);
  RC_ASSERT(std::abs(energy(p, x) - expected) < 1e-5 * (1 + expected));  // the differences' (2e-3 rad)^2
}

RC_GTEST_PROP(WithPayload, GravityIsTheGradientOfTheBodiesPotential, ()) {
  const Parameters p = loaded(robot());
  const Bodies bodies{p};
  const Joints<double> q = pair_between(-4, 4), g = gravity_torque(p, q);
  constexpr double kStep = 1e-5;
  for (std::size_t j = 0; j < kJoints; ++j) {
    Joints<double> after = q, before = q;
    after[j] += kStep;
    before[j] -= kStep;
    const double slope = (bodies.potential(after) - bodies.potential(before)) / (2 * kStep);
    RC_ASSERT(std::abs(g[j] - slope) < 1e-8);  // h^2 / 6 of 10 N m, and roundings of 20 J over h
  }
}

RC_GTEST_PROP(WithPayload, MassMatrixIsPositiveDefinite, ()) {
  const MassMatrix<double> m = mass_matrix(loaded(robot()), between(-4, 4));
  RC_ASSERT(m.m11 > 0);
  RC_ASSERT(m.m11 * m.m22 - m.m12 * m.m12 > 0);
}

// ---- energy ----

// dE/dt = tau_m dtheta - tau_fm(dtheta) dtheta - D dq^2, at every state and not only along a motion.
RC_GTEST_PROP(Energy, ChangesByThePowerOfDriveAndFriction, ()) {
  const Parameters p = complete();
  const State<double> x = any_state();
  const Joints<double> tau = pair_between(-12, 12);
  State<Dual<8>> active;
  for (int i = 0; i < kStates; ++i) active[i] = Dual<8>::input(x[i], i);
  const Dual<8> e = energy(p, active);
  const State<double> rate = dynamics(p, x, tau);
  double change = 0, power = 0;
  for (int i = 0; i < kStates; ++i) change += e.g[static_cast<std::size_t>(i)] * rate[i];
  for (int j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    power += (tau[i] - FrictionLaw::of(p, j).torque(x.dtheta[i])) * x.dtheta[i] - p.link.damping[i] * x.dq[i] * x.dq[i];
  }
  RC_ASSERT(std::abs(change - power) < 1e-10);  // terms up to 1e4 W cancel: 50 roundings of the largest
}

State<double> plus(const State<double>& x, double a, const State<double>& f) {
  State<double> r = x;
  for (int i = 0; i < kStates; ++i) r[i] += a * f[i];
  return r;
}

// Largest change of energy within two seconds of swinging, by classical Runge-Kutta steps of h.
template <class Rate>
double energy_drift(const Parameters& p, const Rate& f, double h) {
  State<double> x{{1.2, -0.9}, {2.0, -5.0}, {1.3, -0.8}, {-1.0, 3.0}};
  const double before = energy(p, x);
  double drift = 0;
  for (long i = 0, steps = std::lround(2 / h); i < steps; ++i) {
    const auto k1 = f(x), k2 = f(plus(x, h / 2, k1)), k3 = f(plus(x, h / 2, k2)), k4 = f(plus(x, h, k3));
    x = plus(plus(plus(plus(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    drift = std::max(drift, std::abs(energy(p, x) - before));
  }
  return drift;
}

State<double> free_motion(const State<double>& x) {
  static const Parameters p = conservative();
  return dynamics(p, x, {0, 0});
}

TEST(Energy, IsConservedWithoutFrictionAndInput) {
  const Parameters p = conservative();
  const double coarse = energy_drift(p, free_motion, 1e-3), fine = energy_drift(p, free_motion, 1e-4);
  EXPECT_LT(fine, 1e-10);         // [J] of some 20; measured 4e-12, the integrator's own:
  EXPECT_GT(coarse / fine, 1e4);  // it falls with the fourth power of the step or faster
}

TEST(WithPayload, EnergyIsConservedWithoutFrictionAndInput) {
  const Parameters p = loaded(conservative());
  const auto free = [&](const State<double>& x) { return dynamics(p, x, {0, 0}); };
  const double coarse = energy_drift(p, free, 1e-3), fine = energy_drift(p, free, 1e-4);
  EXPECT_LT(fine, 1e-10);  // as without
  EXPECT_GT(coarse / fine, 1e4);
}

// The link side with C dq as a function of (q2, dq1, dq2), everything else as in the model.
template <class Coriolis>
State<double> own_dynamics(const Parameters& p, const State<double>& x, const Coriolis& coriolis) {
  const MassMatrix<double> m = mass_matrix(p, x.q[1]);
  const Joints<double> c = coriolis(x.q[1], x.dq[0], x.dq[1]), g = gravity_torque(p, x.q);
  const Joints<double> tau_c = spring_torque(p, x.q, x.theta);
  const double r1 = tau_c[0] - c[0] - g[0], r2 = tau_c[1] - c[1] - g[1], det = m.m11 * m.m22 - m.m12 * m.m12;
  return {x.dq,
          {(m.m22 * r1 - m.m12 * r2) / det, (m.m11 * r2 - m.m12 * r1) / det},
          x.dtheta,
          {-tau_c[0] / p.motor.inertia[0], -tau_c[1] / p.motor.inertia[1]}};
}

TEST(Energy, IsNotConservedByThePrintedCoriolisMatrix) {
  const Parameters p = conservative();
  const double a = coupling(p);
  const auto with_c12 = [a](double c12_rate, double q2, double dq1, double dq2) {  // (23), C12 = -a c12_rate sin q2
    return Joints<double>{-2 * a * dq2 * std::sin(q2) * dq1 - a * c12_rate * std::sin(q2) * dq2,
                          a * dq1 * std::sin(q2) * dq1};
  };
  const auto printed = [&](const State<double>& x) {
    return own_dynamics(p, x, [&](double q2, double dq1, double dq2) { return with_c12(dq1, q2, dq1, dq2); });
  };
  const auto lagrangian = [&](const State<double>& x) {
    return own_dynamics(p, x, [&](double q2, double dq1, double dq2) { return with_c12(dq2, q2, dq1, dq2); });
  };
  EXPECT_LT(energy_drift(p, lagrangian, 1e-4), 1e-10);  // as the model: the copy differs in nothing else
  const double lost = energy_drift(p, printed, 1e-4);
  EXPECT_GT(lost, 1);                                       // [J] measured 2.3,
  EXPECT_NEAR(lost, energy_drift(p, printed, 2e-4), 1e-6);  // whatever the step
}

// ---- rest ----

RC_GTEST_PROP(Rest, IsAnEquilibriumUnderTheTorqueOfGravity, ()) {
  const Joints<double> q = pair_between(-3.2, 3.2);
  const State<double> x = rest_at(robot(), q);
  const State<double> rate = dynamics(robot(), x, gravity_torque(robot(), q));
  RC_ASSERT(x.q == q);
  // theta - q loses 2e-16 K (rad, N m/rad) to rounding; over the smallest inertia, 0.0116 kg m^2, that is 1e-12
  // rad/s^2.
  for (int i = 0; i < kStates; ++i) RC_ASSERT(std::abs(rate[i]) < 1e-11);
}

TEST(Rest, HangsStraightDown) {
  const State<double> x = rest_at(robot(), {0, 0});
  for (int i = 0; i < kStates; ++i) EXPECT_EQ(x[i], 0);
}

// ---- one formula for every scalar ----

template <class D>
State<D> active_dynamics(const Parameters& p, const State<double>& x, const Joints<double>& tau) {
  State<D> state;
  for (int i = 0; i < kStates; ++i) state[i] = D::input(x[i], i);
  return dynamics(p, state, {D::input(tau[0], kStates), D::input(tau[1], kStates + 1)});
}

RC_GTEST_PROP(Dynamics, HaveTheSameValueForEveryScalar, ()) {
  const Parameters p = complete();
  const State<double> x = any_state();
  const Joints<double> tau = pair_between(-12, 12);
  const State<double> plain = dynamics(p, x, tau);
  const auto first = active_dynamics<Dual<10>>(p, x, tau);
  const auto second = active_dynamics<Dual2<10>>(p, x, tau);
  for (int i = 0; i < kStates; ++i) {
    // Division is a product with the inverse there: roundings of accelerations up to 1e4 rad/s^2.
    const double rounding = 1e-14 * (1e3 + std::abs(plain[i]));
    RC_ASSERT(std::abs(first[i].v - plain[i]) < rounding);
    RC_ASSERT(std::abs(second[i].v - plain[i]) < rounding);
    for (std::size_t k = 0; k < 10; ++k) {
      RC_ASSERT(std::abs(first[i].g[k] - second[i].g[k]) <= 1e-12 * (1 + std::abs(first[i].g[k])));
    }
  }
}

// The closed form against dual numbers carried through the equation of motion, with inputs that depend on one another.
// Measured on 100,000 states: 1e-14 of the largest; rounding, and the determinant's cancellation.
template <class D, class Check>
void compare_with_duals(const State<double>& at, Check&& check) {
  constexpr int kInputs = D::kInputs;
  State<D> x;
  for (std::size_t i = 0; i < kStates; ++i) {
    const D input = D::input(at[i], static_cast<int>(i) % kInputs);
    x[i] = i < static_cast<std::size_t>(kInputs) ? input : at[i] + 0.7 * (input - input.v) + sin(input - input.v);
  }
  const Parameters p = complete();
  const Joints<D> closed = link_acceleration(p, x);
  const Joints<D> carried = link_acceleration(p, x.q, x.dq, spring_torque(p, x.q, x.theta));
  for (std::size_t j = 0; j < kJoints; ++j) check(closed[j], carried[j]);
}

RC_GTEST_PROP(LinkAcceleration, HasTheDerivativesThatDualNumbersCarry, ()) {
  constexpr double kRounding = 1e-12;
  const State<double> at = any_state();
  compare_with_duals<Dual<5>>(at, [&](const Dual<5>& closed, const Dual<5>& carried) {
    RC_ASSERT(std::abs(closed.v - carried.v) <= kRounding * 1e3);
    for (std::size_t i = 0; i < 5; ++i) RC_ASSERT(std::abs(closed.g[i] - carried.g[i]) <= kRounding * 1e5);
  });
  const auto second = [&](const auto& closed, const auto& carried) {
    constexpr auto kInputs = static_cast<std::size_t>(std::decay_t<decltype(closed)>::kInputs);
    for (std::size_t i = 0; i < kInputs; ++i) {
      RC_ASSERT(std::abs(closed.g[i] - carried.g[i]) <= kRounding * 1e5);
      for (std::size_t k = 0; k <= i; ++k) {
        RC_ASSERT(std::abs(closed.second(i, k) - carried.second(i, k)) <= kRounding * 1e6);
      }
    }
  };
  compare_with_duals<Dual2<5>>(at, second);
  compare_with_duals<Dual2<8>>(at, second);
}

RC_GTEST_PROP(Dynamics, CompensatedTorqueTakesTheFrictionOut, ()) {
  const State<double> x = any_state();
  const Joints<double> u = pair_between(-12, 12);
  Joints<double> tau = u;
  for (int j = 0; j < kJoints; ++j) {
    tau[static_cast<std::size_t>(j)] += FrictionLaw::of(robot(), j).nonlinear(x.dtheta[static_cast<std::size_t>(j)]);
  }
  const State<double> a = dynamics(robot(), x, tau), b = compensated_dynamics(robot(), x, u);
  // One rounding of 14 N m over the smallest motor inertia, 0.0145 kg m^2.
  for (int i = 0; i < kStates; ++i) RC_ASSERT(std::abs(a[i] - b[i]) < 1e-12);
}

}  // namespace
}  // namespace fjr
