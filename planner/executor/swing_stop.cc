#include "planner/executor/swing_stop.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fjr {
namespace {

constexpr std::array<double, 9> kDurations{0.1, 0.13, 0.16, 0.2, 0.25, 0.32, 0.4, 0.5, 0.62};  // [s]
constexpr int kInstants = 16;                      // instants at which limits are checked
constexpr double kPosition = 0.2, kVelocity = 15;  // observer gains; a count of the encoder causes 1.4e-3 rad/s

// Returns q(1) - q(0) of the polynomial of lowest degree with the derivatives `start` at s = 0 and four zero
// derivatives at s = 1: dq/ds = (1-s)^4 (a + b s + c s^2 + d s^3).
double natural_end(const std::array<double, 5>& start) {
  const double a = start[1];
  const double b = start[2] + 4 * a;
  const double c = start[3] / 2 + 4 * b - 6 * a;
  const double d = start[4] / 6 + 4 * c - 6 * b + 4 * a;
  return a / 5 + b / 30 + c / 105 + d / 280;
}

Joints<StopShape> natural_shapes(const LinkMotion& from, double duration) {
  Joints<StopShape> shapes = shapes_from(from, duration);
  for (StopShape& shape : shapes) shape.free[0] = natural_end(shape.start);
  return shapes;
}

}  // namespace

void SwingObserver::start(const Joints<double>& q) {
  q_ = q;
  dq_ = {};
}

void SwingObserver::tick(const Joints<double>& q, const Joints<double>& theta) {
  const Joints<double> acceleration = link_acceleration(robot_, q, dq_, spring_torque(robot_, q, theta));
  for (std::size_t j = 0; j < kJoints; ++j) {
    q_[j] += dq_[j] * kTick + acceleration[j] * kTick * kTick / 2;
    dq_[j] += acceleration[j] * kTick;
    const double off = q[j] - q_[j];
    q_[j] += kPosition * off;
    dq_[j] += kVelocity * off;
  }
}

// Each link is modelled as a mass m on a spring K whose other end is held by a damper D. Its characteristic equation m
// D s^2 + m K s + K D = 0 has the damping ratio sqrt(m K) / (2 D).
MotorFeedback::Command yielding_torque(const Parameters& robot, const Joints<double>& q, const Joints<double>& dtheta) {
  constexpr double kDampingRatio = 0.7;
  const MassMatrix<double> mass = mass_matrix(robot, q[1]);
  const Joints<double> inertia{mass.m11, mass.m22}, weight = gravity_torque(robot, q);
  MotorFeedback::Command c{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double damping = std::sqrt(inertia[j] * robot.spring.stiffness[j]) / (2 * kDampingRatio);
    const double peak = robot.drive.peak_torque[j], wanted = weight[j] - damping * dtheta[j];
    c.torque[j] = std::clamp(wanted, -peak, peak);
    c.saturated |= std::abs(wanted) > peak;
  }
  return c;
}

SwingStop::SwingStop(const Parameters& robot)
    : robot_(robot), limits_(in_order(stop_limits(robot))), table_(kInstants) {
  for (std::size_t i = 0; i < kStopLimits; ++i) {
    if (kStopLimitNames[i].quantity->of_oscillation) limits_[i] = kNoLimit;
  }
}

bool SwingStop::find(double start, const State<double>& swinging) {
  const LinkMotion from = link_motion(robot_, swinging, spring_torque(robot_, swinging.q, swinging.theta));
  start_ = start;
  for (const double duration : kDurations) {
    shapes_ = natural_shapes(from, duration);
    duration_ = duration;
    if (largest_fraction(shapes_, duration) <= 1) return true;
  }
  return false;
}

// Returns the largest fraction of any limit that the stop uses.
double SwingStop::largest_fraction(const Joints<StopShape>& shapes, double duration) const {
  double largest = 0;
  for (int n = 0; n <= kInstants; ++n) {
    const FlatPoint p = from_link_motion(robot_, in_time({table_.at(shapes[0], n), table_.at(shapes[1], n)}, duration));
    const PerStopLimit values = stop_values(robot_, p.state, p.torque);
    for (std::size_t i = 0; i < kStopLimits; ++i) largest = std::max(largest, std::abs(values[i]) / limits_[i]);
  }
  return largest;
}

Sample SwingStop::at(double time) const {
  const double s = std::clamp((time - start_) / duration_, 0.0, 1.0);
  const LinkMotion motion = in_time({evaluate(shapes_[0], s), evaluate(shapes_[1], s)}, duration_);
  if (s >= 1) return {time, rest_at(robot_, motion.q), gravity_torque(robot_, motion.q)};
  const FlatPoint p = from_link_motion(robot_, motion);
  return {time, p.state, p.torque};
}

}  // namespace fjr
