// The arm of the paper once more, for those who believe nobody: in long double, from its Lagrangian (19)-(21) and its
// friction law (24), with an integrator of its own. Nothing here is the program's but the numbers in robot.yaml.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "model/parameters.h"
#include "planner/trajectory/trajectory.h"

namespace fjr::independent {

using Real = long double;
using Numbers = std::array<Real, 8>;  // q1, q2, dq1, dq2, theta1, theta2, dtheta1, dtheta2
using PerJoint = std::array<Real, 2>;

struct Arm {
  Parameters p;

  // (24)
  Real friction(std::size_t j, Real v) const {
    const Real f = p.friction.amplitude[j], s = v / p.friction.width[j], inner = std::tanh(s);
    return p.friction.viscous[j] * v + f * inner -
           f * p.friction.second_weight[j] * std::tanh(s - p.friction.second_shape[j] * inner);
  }

  // (1), for a payload that is a body at the tip. tau: of the motors [N m].
  Numbers rate(const Numbers& x, const PerJoint& tau) const {
    const Real l1 = p.link.length[0], l2 = p.link.length[1], m2 = p.link.mass[1], r2 = p.link.com_fraction[1] * l2,
               mp = p.payload.mass, weight = mp * 9.8L;  // g of (6) and (7)
    const Real inner = p.link.inertia[1] + m2 * r2 * r2 + p.payload.inertia + mp * l2 * l2,
               bend = l1 * (m2 * r2 + mp * l2);
    const Real c = std::cos(x[1]), s = std::sin(x[1]);
    const Real m11 = p.link.inertia[0] + (m2 + mp) * l1 * l1 + inner + 2 * bend * c, m12 = inner + bend * c,
               m22 = inner;
    const Real sag = x[0] - p.mounting.down, slope = p.mounting.gravity;
    const Real g2 = slope * (p.link.gravity_torque[1] + weight * l2) * std::sin(sag + x[1]),
               g1 = slope * (p.link.gravity_torque[0] + weight * l1) * std::sin(sag) + g2;
    const PerJoint spring{p.spring.stiffness[0] * (x[4] - x[0]), p.spring.stiffness[1] * (x[5] - x[1])};
    const Real forced1 = spring[0] - g1 - p.link.damping[0] * x[2] + bend * s * (2 * x[2] * x[3] + x[3] * x[3]),
               forced2 = spring[1] - g2 - p.link.damping[1] * x[3] - bend * s * x[2] * x[2];
    const Real determinant = m11 * m22 - m12 * m12;
    Numbers f{x[2], x[3], (m22 * forced1 - m12 * forced2) / determinant, (m11 * forced2 - m12 * forced1) / determinant,
              x[6], x[7]};
    for (std::size_t j = 0; j < 2; ++j) f[6 + j] = (tau[j] - spring[j] - friction(j, x[6 + j])) / p.motor.inertia[j];
    return f;
  }
};

// What is published between two rows: positions cubic, velocities their derivatives, torques linear.
struct Between {
  const Sample &a, &b;

  Real length() const { return static_cast<Real>(b.time) - a.time; }
  Numbers state(Real t) const {
    Numbers x{};
    for (std::size_t i = 0; i < 8; ++i) {
      if (i / 2 % 2 == 1) continue;
      const Real h = length(), s = t / h, x0 = a.state[i], x1 = b.state[i], v0 = h * a.state[i + 2],
                 v1 = h * b.state[i + 2];
      const Real c2 = 3 * (x1 - x0) - 2 * v0 - v1, c3 = 2 * (x0 - x1) + v0 + v1;
      x[i] = x0 + s * (v0 + s * (c2 + s * c3));
      x[i + 2] = (v0 + s * (2 * c2 + 3 * s * c3)) / h;
    }
    return x;
  }
  PerJoint torque(Real t) const {
    const Real s = t / length();
    return {a.torque[0] + s * (static_cast<Real>(b.torque[0]) - a.torque[0]),
            a.torque[1] + s * (static_cast<Real>(b.torque[1]) - a.torque[1])};
  }
};

// What the exact motion under the rows' torque came to.
struct Errors {
  Real link = 0;              // [rad]   largest |q - plan|, between steps too
  Real link_velocity = 0;     // [rad/s] largest |dq - plan|
  PerJoint motor_velocity{};  // [rad/s] largest |dtheta - plan|
  PerJoint feedback{};        // [N m]   largest
};

// The largest magnitude over [0, h] of a cubic with these values and slopes at the ends.
inline Real largest_of_cubic(Real e0, Real v0, Real e1, Real v1, Real h) {
  Real most = std::max(std::abs(e0), std::abs(e1));
  const Real c1 = h * v0, c2 = 3 * (e1 - e0) - h * (2 * v0 + v1), c3 = 2 * (e0 - e1) + h * (v0 + v1);
  const Real root = std::sqrt(std::max<Real>(0, c2 * c2 - 3 * c1 * c3)), q = -(c2 + std::copysign(root, c2));
  for (const Real s : {q / (3 * c3), c1 / q}) {
    if (s > 0 && s < 1) most = std::max(most, std::abs(e0 + s * (c1 + s * (c2 + s * c3))));
  }
  return most;
}

// The exact motion from the first row on. closed: with the executor's gains on the exact state; of motions that rest
// nowhere, where there would be dither too.
class Run {
 public:
  Run(const Arm& arm, const Trajectory& trajectory, bool closed) : arm_(arm), closed_(closed) {
    for (std::size_t i = 0; i < 8; ++i) x_[i] = trajectory.samples.front().state[i];
    for (std::size_t row = 0; row + 1 < trajectory.samples.size() && std::isfinite(errors_.link); ++row) {
      follow({trajectory.samples[row], trajectory.samples[row + 1]});
    }
  }
  const Errors& errors() const { return errors_; }

 private:
  static constexpr Real kTolerance = 1e-13L;  // of a step, of components of size 1

  PerJoint feedback(const Between& plan, Real t, const Numbers& x) const {
    if (!closed_) return {};
    const Numbers wanted = plan.state(t);
    PerJoint u;
    for (std::size_t j = 0; j < 2; ++j) {
      u[j] = arm_.p.feedback.position_gain[j] * (wanted[4 + j] - x[4 + j]) +
             arm_.p.feedback.velocity_gain[j] * (wanted[6 + j] - x[6 + j]);
    }
    return u;
  }
  Numbers rate(const Between& plan, Real t, const Numbers& x) const {
    const PerJoint u = feedback(plan, t, x), tau = plan.torque(t);
    return arm_.rate(x, {tau[0] + u[0], tau[1] + u[1]});
  }

  // Dormand & Prince's method of order 5 with error control; the last step ends with the row.
  void follow(const Between& plan) {
    const Real end = plan.length();
    compare(plan, 0, x_, 0);
    for (Real t = 0; t < end;) {
      const bool is_last = usual_ >= end - t;
      const Real h = is_last ? end - t : usual_;
      const auto [next, error] = step(plan, t, h);
      const Real factor = std::clamp<Real>(0.9L * std::pow(error + 1e-30L, -0.2L), 0.2L, 3);
      if (error <= 1) {
        const Numbers before = x_;
        x_ = next;
        t = is_last ? end : t + h;
        compare(plan, t, before, h);
        if (!is_last || factor < 1) usual_ = h * factor;
      } else if (h < 1e-15L) {
        errors_.link = HUGE_VALL;
        return;
      } else {
        usual_ = h * (std::isfinite(error) ? factor : 0.2L);
      }
    }
  }

  std::pair<Numbers, Real> step(const Between& plan, Real t, Real h) const {
    static constexpr std::array<std::array<Real, 6>, 6> kWeights{
        {{1.0L / 5},
         {3.0L / 40, 9.0L / 40},
         {44.0L / 45, -56.0L / 15, 32.0L / 9},
         {19372.0L / 6561, -25360.0L / 2187, 64448.0L / 6561, -212.0L / 729},
         {9017.0L / 3168, -355.0L / 33, 46732.0L / 5247, 49.0L / 176, -5103.0L / 18656},
         {35.0L / 384, 0, 500.0L / 1113, 125.0L / 192, -2187.0L / 6784, 11.0L / 84}}};
    static constexpr std::array<Real, 6> kNodes{0.2L, 0.3L, 0.8L, 8.0L / 9, 1, 1};
    static constexpr std::array<Real, 7> kError{71.0L / 57600,      0,           -71.0L / 16695, 71.0L / 1920,
                                                -17253.0L / 339200, 22.0L / 525, -1.0L / 40};
    std::array<Numbers, 7> k;
    Numbers y = x_;
    for (std::size_t stage = 0; stage < k.size(); ++stage) {
      k[stage] = rate(plan, stage == 0 ? t : t + kNodes[stage - 1] * h, y);
      if (stage == 6) break;
      y = x_;
      for (std::size_t before = 0; before <= stage; ++before) {
        for (std::size_t i = 0; i < 8; ++i) y[i] += h * kWeights[stage][before] * k[before][i];
      }
    }
    Real error = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      Real off = 0;
      for (std::size_t stage = 0; stage < k.size(); ++stage) off += h * kError[stage] * k[stage][i];
      const Real fraction = std::abs(off) / (kTolerance * (1 + std::abs(x_[i])));
      error = fraction >= error || std::isnan(fraction) ? fraction : error;
    }
    return {y, error};
  }

  // After a step of length h to t, which began in `before`.
  void compare(const Between& plan, Real t, const Numbers& before, Real h) {
    const Numbers wanted = plan.state(t), wanted_before = plan.state(t - h);
    const PerJoint u = feedback(plan, t, x_);
    for (std::size_t j = 0; j < 2; ++j) {
      const Real off = largest_of_cubic(before[j] - wanted_before[j], before[2 + j] - wanted_before[2 + j],
                                        x_[j] - wanted[j], x_[2 + j] - wanted[2 + j], h);
      errors_.link = std::max(errors_.link, off);
      errors_.link_velocity = std::max(errors_.link_velocity, std::abs(x_[2 + j] - wanted[2 + j]));
      errors_.motor_velocity[j] = std::max(errors_.motor_velocity[j], std::abs(x_[6 + j] - wanted[6 + j]));
      errors_.feedback[j] = std::max(errors_.feedback[j], std::abs(u[j]));
    }
  }

  const Arm& arm_;
  bool closed_;
  Numbers x_{};
  Real usual_ = 1e-6L;  // length of the next step [s]
  Errors errors_;
};

inline Errors errors_of(const Arm& arm, const Trajectory& trajectory, bool closed) {
  return Run(arm, trajectory, closed).errors();
}

}  // namespace fjr::independent
