// Trajectories of the shipped robot that are exact by construction: their states follow from their torque by an
// integration that shares no code with the certificate's.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "model/dynamics.h"
#include "model/parameters.h"
#include "planner/certificate/certificate.h"
#include "planner/control/motor_feedback.h"
#include "planner/problem/quantities.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

inline const Parameters& robot() {
  static const Parameters p = load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  return p;
}

inline Limits robot_limits() {
  Limits l;
  l.torque = robot().limits.torque;
  l.motor_velocity = robot().limits.motor_velocity;
  l.link_position = robot().limits.link_position;
  l.spring_deflection = robot().limits.spring_deflection;
  return l;
}

// ---- an independent integrator: classical Runge-Kutta, small fixed steps, smaller ones within the friction step ----

using TorqueLaw = std::function<Joints<double>(double, const State<double>&)>;

inline State<double> plus(const State<double>& x, double a, const State<double>& f) {
  State<double> r = x;
  for (int i = 0; i < kStates; ++i) r[i] += a * f[i];
  return r;
}

inline State<double> runge_kutta_step(const TorqueLaw& tau, double t, const State<double>& x, double h) {
  const auto f = [&](double at, const State<double>& y) { return dynamics(robot(), y, tau(at, y)); };
  const State<double> k1 = f(t, x), k2 = f(t + h / 2, plus(x, h / 2, k1)), k3 = f(t + h / 2, plus(x, h / 2, k2)),
                      k4 = f(t + h, plus(x, h, k3));
  return plus(plus(plus(plus(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
}

inline State<double> integrate(const TorqueLaw& tau, double from, double to, State<double> x) {
  constexpr double kCoarse = 4e-6, kFine = 2e-8, kNearRest = 3e-3;  // [s], [s], [rad/s]
  double t = from;
  while (t < to) {
    const double slowest = std::min(std::abs(x.dtheta[0]), std::abs(x.dtheta[1]));
    const double h = std::min(slowest < kNearRest ? kFine : kCoarse, to - t);
    x = runge_kutta_step(tau, t, x, h);
    t = to - t <= h ? to : t + h;
  }
  return x;
}

// ---- trajectories ----

inline Joints<double> smooth_torque(double t) {
  const double s = std::sin(2 * std::numbers::pi * t / 0.43);
  return {5 * s, 1.5 * s};
}

// Rows every `period` whose states follow exactly from their piecewise linear torque.
inline Trajectory exact_trajectory(const std::function<Joints<double>(double)>& torque, double duration,
                                   double period) {
  Trajectory trajectory;
  const int rows = static_cast<int>(std::lround(duration / period));
  Sample row{0, rest_at(robot(), {0.1, -0.2}), torque(0)};
  trajectory.samples.push_back(row);
  for (int k = 1; k <= rows; ++k) {
    const Sample next{k * period, {}, torque(k * period)};
    const auto linear = [&](double t, const State<double>&) {
      const double s = (t - row.time) / (next.time - row.time);
      return Joints<double>{row.torque[0] + s * (next.torque[0] - row.torque[0]),
                            row.torque[1] + s * (next.torque[1] - row.torque[1])};
    };
    const State<double> x = integrate(linear, row.time, next.time, row.state);
    row = next;
    row.state = x;
    trajectory.samples.push_back(row);
  }
  return trajectory;
}

inline const Trajectory& reference_trajectory() {
  static const Trajectory trajectory = exact_trajectory(smooth_torque, 0.43, 1e-3);
  return trajectory;
}

// At rest at q for a while, with exactly the right torque.
inline Trajectory resting(const Joints<double>& q, double duration) {
  Trajectory trajectory;
  const int rows = static_cast<int>(std::lround(duration / 1e-3));
  for (int k = 0; k <= rows; ++k) {
    trajectory.samples.push_back({k * 1e-3, rest_at(robot(), q), gravity_torque(robot(), q)});
  }
  return trajectory;
}

// Returns the application of a change to every row.
template <class Change>
std::function<void(std::vector<Sample>&)> in_every_row(Change change) {
  return [change](std::vector<Sample>& rows) { std::for_each(rows.begin(), rows.end(), change); };
}

inline Certificate certificate_of(const Trajectory& trajectory) { return certify(robot(), robot_limits(), trajectory); }

// Off by so many counts of the link encoders, the motors with the links.
inline State<double> moved(State<double> x, const Joints<double>& counts) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    x.q[j] += counts[j] * count_angle(robot().encoder.link_counts[j]);
    x.theta[j] += counts[j] * count_angle(robot().encoder.link_counts[j]);
  }
  return x;
}

}  // namespace fjr
