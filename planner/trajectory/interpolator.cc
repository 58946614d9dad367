#include <algorithm>

#include "planner/trajectory/trajectory.h"

namespace fjr {
namespace {

double between(double from, double to, double fraction) { return from + fraction * (to - from); }

Joints<double> linear_torque(const Sample& a, const Sample& b, double fraction) {
  return {between(a.torque[0], b.torque[0], fraction), between(a.torque[1], b.torque[1], fraction)};
}

double fraction_of(const Sample& a, const Sample& b, double time) {
  return std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
}

struct Hermite {
  double position, velocity;
};

// Evaluates the cubic through x0 and x1 with slopes v0 and v1 at the ends of an interval of length h, at s in [0, 1].
Hermite hermite(double x0, double v0, double x1, double v1, double h, double s) {
  const double secant = (x1 - x0) / h;
  const double curve0 = v0 - secant, curve1 = v1 - secant;  // deviations of the end slopes from the secant
  const double r = 1 - s;
  return {between(x0, x1, s) + h * s * r * (r * curve0 - s * curve1),
          secant + r * (1 - 3 * s) * curve0 + s * (3 * s - 2) * curve1};
}

}  // namespace

std::size_t Interpolator::interval(double time) {
  const std::vector<Sample>& rows = trajectory_->samples;
  const auto holds = [&](std::size_t k) { return rows[k].time <= time && time < rows[k + 1].time; };
  if (holds(last_)) return last_;
  if (last_ + 2 < rows.size() && holds(last_ + 1)) return ++last_;
  const auto after = std::upper_bound(rows.begin() + 1, rows.end() - 1, time,
                                      [](double t, const Sample& row) { return t < row.time; });
  return last_ = static_cast<std::size_t>(after - rows.begin()) - 1;
}

Sample Interpolator::at(double time) {
  const std::size_t k = interval(time);
  const Sample& a = trajectory_->samples[k];
  const Sample& b = trajectory_->samples[k + 1];
  const double h = b.time - a.time, s = fraction_of(a, b, time);
  Sample out;
  out.time = a.time + s * h;
  out.torque = linear_torque(a, b, s);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const Hermite link = hermite(a.state.q[j], a.state.dq[j], b.state.q[j], b.state.dq[j], h, s);
    const Hermite motor = hermite(a.state.theta[j], a.state.dtheta[j], b.state.theta[j], b.state.dtheta[j], h, s);
    out.state.q[j] = link.position;
    out.state.dq[j] = link.velocity;
    out.state.theta[j] = motor.position;
    out.state.dtheta[j] = motor.velocity;
  }
  return out;
}

Joints<double> Interpolator::torque_at(double time) {
  const std::size_t k = interval(time);
  const Sample& a = trajectory_->samples[k];
  const Sample& b = trajectory_->samples[k + 1];
  return linear_torque(a, b, fraction_of(a, b, time));
}

Joints<double> Interpolator::mean_torque(double from, double to) {
  const std::vector<Sample>& rows = trajectory_->samples;
  if (!(to > from)) return torque_at(from);
  Joints<double> area{};
  Joints<double> left = torque_at(from);
  double at = from;
  for (std::size_t k = from < rows.front().time ? 0 : interval(from) + 1; at < to; ++k) {
    // Before the first sample and after the last one the torque is constant, as everywhere in this class.
    const bool inside = k < rows.size() && rows[k].time < to;
    const double next = inside ? std::max(rows[k].time, at) : to;
    const Joints<double> right = inside ? rows[k].torque : torque_at(to);
    for (std::size_t j = 0; j < kJoints; ++j) area[j] += 0.5 * (left[j] + right[j]) * (next - at);
    left = right;
    at = next;
  }
  return {area[0] / (to - from), area[1] / (to - from)};
}

}  // namespace fjr
