#include "planner/certificate/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "model/kinematics.h"
#include "planner/certificate/thresholds.h"

namespace fjr {
namespace {

struct Extreme {
  double magnitude = 0, time = 0;
  void include(double value, double at) {
    if (std::abs(value) > magnitude) {
      magnitude = std::abs(value);
      time = at;
    }
  }
};

// x(s) = x0 + h s (v0 + s (b + s a)) is the cubic Hermite of an interval; s in [0, 1].
struct Cubic {
  double start, h, x0, v0, a, b;

  Cubic(double t0, double t1, double from, double v_from, double to, double v_to)
      : start(t0), h(t1 - t0), x0(from), v0(v_from) {
    const double secant = (to - from) / h;
    a = v_from + v_to - 2 * secant;
    b = 3 * secant - 2 * v_from - v_to;
  }

  double time(double s) const { return start + s * h; }
  double value(double s) const { return x0 + h * s * (v0 + s * (b + s * a)); }
  double slope(double s) const { return v0 + s * (2 * b + s * 3 * a); }

  void include_values(Extreme& e) const {
    e.include(value(0), time(0));
    e.include(value(1), time(1));
    for (const double s : stationary()) {
      if (s > 0 && s < 1) e.include(value(s), time(s));
    }
  }

  void include_slopes(Extreme& e) const {
    e.include(slope(0), time(0));
    e.include(slope(1), time(1));
    const double vertex = -b / (3 * a);
    if (vertex > 0 && vertex < 1) e.include(slope(vertex), time(vertex));
  }

 private:
  // Zeros of the slope 3 a s^2 + 2 b s + v0, without cancellation; NaN or infinite where there is none.
  std::array<double, 2> stationary() const {
    const double root = -(b + std::copysign(std::sqrt(b * b - 3 * a * v0), b));
    return {root / (3 * a), v0 / root};
  }
};

// Largest over all intervals; piece(row, next row) is the cubic to look at.
template <class Piece>
Extreme over_intervals(const Trajectory& trajectory, const Piece& piece, void (Cubic::*include)(Extreme&) const) {
  Extreme e;
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    (piece(trajectory.samples[k], trajectory.samples[k + 1]).*include)(e);
  }
  return e;
}

Extreme torque(const Parameters&, const Trajectory& trajectory, std::size_t j) {
  Extreme e;
  for (const Sample& row : trajectory.samples) e.include(row.torque[j], row.time);
  return e;
}

Extreme motor_velocity(const Parameters&, const Trajectory& trajectory, std::size_t j) {
  const auto motor = [j](const Sample& a, const Sample& b) {
    return Cubic(a.time, b.time, a.state.theta[j], a.state.dtheta[j], b.state.theta[j], b.state.dtheta[j]);
  };
  return over_intervals(trajectory, motor, &Cubic::include_slopes);
}

Extreme link_position(const Parameters&, const Trajectory& trajectory, std::size_t j) {
  const auto link = [j](const Sample& a, const Sample& b) {
    return Cubic(a.time, b.time, a.state.q[j], a.state.dq[j], b.state.q[j], b.state.dq[j]);
  };
  return over_intervals(trajectory, link, &Cubic::include_values);
}

Extreme spring_deflection(const Parameters&, const Trajectory& trajectory, std::size_t j) {
  const auto spring = [j](const Sample& a, const Sample& b) {
    const State<double>&x = a.state, &y = b.state;
    return Cubic(a.time, b.time, x.theta[j] - x.q[j], x.dtheta[j] - x.dq[j], y.theta[j] - y.q[j],
                 y.dtheta[j] - y.dq[j]);
  };
  return over_intervals(trajectory, spring, &Cubic::include_values);
}

Extreme torque_rate(const Parameters& p, const Trajectory& trajectory, std::size_t j) {
  const FrictionLaw law = FrictionLaw::of(p, static_cast<int>(j));
  const auto u = [&](const Sample& row) { return row.torque[j] - law.nonlinear(row.state.dtheta[j]); };
  const std::vector<Sample>& rows = trajectory.samples;
  const double apart = 0.5 * longest_interval(trajectory);
  Extreme e;
  for (std::size_t before = 0, k = 1; k < rows.size(); ++k) {
    if (rows[k].time - rows[before].time < apart) continue;
    while (rows[k].time - rows[before + 1].time >= apart) ++before;
    e.include((u(rows[k]) - u(rows[before])) / (rows[k].time - rows[before].time), rows[k].time);
  }
  return e;
}

Extreme tip_speed(const Parameters& p, const Trajectory& trajectory) {
  Interpolator plan(trajectory);
  Extreme e;
  const auto include = [&](double time) {
    const State<double> x = plan.at(time).state;
    e.include(std::sqrt(tip_speed_squared(p, x.q[1], x.dq)), time);
  };
  include(trajectory.start_time());
  for (const double time : comparison_instants(trajectory)) include(time);
  return e;
}

bool within(const LimitCheck& c, double allowed) {
  return c.reached <= c.limit * (1 + kPublishedShare) && c.rollout <= allowed;
}

// What there is to know about one limit of one joint.
struct Quantity {
  const char* name;
  double limit, allowed;  // of the plan, of the rollout
  Extreme (*published)(const Parameters&, const Trajectory&, std::size_t);
  std::optional<double> rollout;     // none: a property of the plan alone
  std::optional<Event::Kind> event;  // that says that the rollout exceeded what it is allowed
};

std::vector<Quantity> quantities(const Limits& limits, const Limits& allowed, const Peaks& peaks, std::size_t j) {
  using Kind = Event::Kind;
  return {{"torque", limits.torque[j], allowed.torque[j], torque, peaks.torque[j], {}},
          {"motor_velocity", limits.motor_velocity[j], allowed.motor_velocity[j], motor_velocity,
           peaks.motor_velocity[j], Kind::kMotorVelocity},
          {"link_position", limits.link_position[j], allowed.link_position[j], link_position, peaks.link_position[j],
           Kind::kLinkPosition},
          {"spring_deflection", limits.spring_deflection[j], allowed.spring_deflection[j], spring_deflection,
           peaks.spring_deflection[j], Kind::kSpringDeflection},
          {"torque_rate", limits.torque_rate[j], allowed.torque_rate[j], torque_rate, {}, {}}};
}

LimitCheck check(const Quantity& quantity, int joint, const Extreme& published, const std::vector<Event>& events) {
  LimitCheck c{quantity.name, joint, quantity.limit, published.magnitude, published.time, published.magnitude, false};
  c.rollout = quantity.rollout.value_or(published.magnitude);
  c.passed = within(c, quantity.allowed);
  // An event is a violation however brief, even where no instant of comparison saw it.
  if (std::any_of(events.begin(), events.end(),
                  [&](const Event& e) { return quantity.event == e.kind && e.joint == joint; })) {
    c.passed = false;
    c.rollout = std::max(c.rollout, quantity.allowed);
  }
  return c;
}

}  // namespace

Limits rollout_allowance(const Parameters& p, const Limits& limits) {
  Limits allowed = limits;
  for (std::size_t j = 0; j < kJoints; ++j) {
    allowed.torque[j] = kNoLimit;       // judged as feedback torque
    allowed.torque_rate[j] = kNoLimit;  // a property of the plan alone
    allowed.motor_velocity[j] *= 1 + kRolloutVelocityShare;
    allowed.link_position[j] += exactness_tolerance(p);
    allowed.spring_deflection[j] += exactness_tolerance(p);
  }
  allowed.tip_speed *= 1 + kRolloutVelocityShare;
  return allowed;
}

std::vector<LimitCheck> check_limits(const Parameters& p, const Limits& limits, const Trajectory& trajectory,
                                     const Comparison& rollout) {
  const Limits allowed = rollout_allowance(p, limits);
  std::vector<LimitCheck> checks;
  for (std::size_t j = 0; j < kJoints; ++j) {
    for (const Quantity& quantity : quantities(limits, allowed, rollout.peaks, j)) {
      if (!std::isfinite(quantity.limit)) continue;
      checks.push_back(check(quantity, static_cast<int>(j) + 1, quantity.published(p, trajectory, j), rollout.events));
    }
  }
  if (std::isfinite(limits.tip_speed)) {
    const Extreme tip = tip_speed(p, trajectory);
    LimitCheck c{"tip_speed", 0, limits.tip_speed, tip.magnitude, tip.time, rollout.peaks.tip_speed, false};
    c.passed = within(c, allowed.tip_speed);
    checks.push_back(c);
  }
  return checks;
}

std::string violation(const LimitCheck& c) {
  const std::string whose = c.joint > 0 ? fmt::format("{} of joint {}", c.name, c.joint) : c.name;
  if (c.reached > c.limit * (1 + kPublishedShare)) {
    return fmt::format("{} reaches {:.9g} at {:.6f} s, its limit is {:.9g}", whose, c.reached, c.time, c.limit);
  }
  return fmt::format("{} reaches {:.9g} in the closed-loop rollout, more than exactness explains; its limit is {:.9g}",
                     whose, c.rollout, c.limit);
}

}  // namespace fjr
