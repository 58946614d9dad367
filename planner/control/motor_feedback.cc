#include "planner/control/motor_feedback.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "model/friction.h"

namespace fjr {
namespace {

constexpr double kLinkFraction = 0.5;  // gain of the link feedback, as a fraction of the stiffness; stable below 1
constexpr double kDitherCounts = 0.1;  // [counts of the link encoder] largest amplitude of the dither

// Applies a dead band: returns how far `error` is outside [-band, band].
double beyond(double error, double band) { return error - std::clamp(error, -band, band); }

}  // namespace

Dither::Dither(const Parameters& p, std::size_t joint, double tick)
    : law_(FrictionLaw::of(p, static_cast<int>(joint))), band_(law_.unstable_band()) {
  const double rate = 2 * std::numbers::pi / (kDitherPeriod * tick);  // [rad/s]
  amplitude_ = std::min(kDitherBands * band_, kDitherCounts * count_angle(p.encoder.link_counts[joint]) * rate);
  for (int k = 0; k < kDitherPeriod; ++k) {
    for (int i = 0; i < kParts; ++i) {
      const double phase = rate * tick * (k + (i + 0.5) / kParts);
      velocities_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] = amplitude_ * std::sin(phase);
      accelerating_[static_cast<std::size_t>(k)] +=
          p.motor.inertia[joint] * amplitude_ * rate * std::cos(phase) / kParts;
    }
  }
}

double Dither::next(double planned_velocity) {
  const bool rests = std::abs(planned_velocity) < band_;
  rested_ = rests ? rested_ + 1 : 0;
  if (swing_tick() == 0) return 0;
  const std::size_t k = (swing_tick() - 1) % kDitherPeriod;
  double friction = 0;
  for (const double velocity : velocities_[k]) friction += law_.torque(planned_velocity + velocity) / kParts;
  return friction - law_.torque(planned_velocity) + accelerating_[k];
}

PlannedDither::PlannedDither(const Parameters& p, const Trajectory& trajectory, double tick)
    : start_(trajectory.start_time()), tick_(tick) {
  Joints<Dither> dither{Dither(p, 0, tick), Dither(p, 1, tick)};
  Interpolator plan(trajectory);
  for (std::size_t k = 0; start_ + static_cast<double>(k) * tick_ < trajectory.end_time(); ++k) {
    const double now = start_ + static_cast<double>(k) * tick_;
    const Joints<double> velocity = plan.at(now).state.dtheta;
    bool steps = false;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const bool before = dither[j].swing_tick() > 0;
      const double torque = dither[j].next(velocity[j]);
      const std::size_t swung = dither[j].swing_tick();
      steps |= before || swung > 0;
      if (swung == 1) swings_[j].push_back({k, {}});
      if (swung > 0) swings_[j].back().torques.push_back(torque);
    }
    if (steps) steps_.push_back(now);
  }
}

Joints<double> PlannedDither::at(double time) const {
  constexpr double kRounding = 1e-6;  // [ticks] the beginning of a tick belongs to it, however its time is rounded
  const auto tick = static_cast<std::size_t>(std::max(0.0, std::floor((time - start_) / tick_ + kRounding)));
  Joints<double> torque{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto after = std::upper_bound(swings_[j].begin(), swings_[j].end(), tick,
                                        [](std::size_t k, const Swing& swing) { return k < swing.first; });
    if (after == swings_[j].begin()) continue;
    const Swing& swing = *std::prev(after);
    if (tick - swing.first < swing.torques.size()) torque[j] = swing.torques[tick - swing.first];
  }
  return torque;
}

MotorFeedback::MotorFeedback(const Parameters& p, double tick)
    : p_(p),
      error_velocity_{VelocityFilter(p.feedback.velocity_filter[0], tick),
                      VelocityFilter(p.feedback.velocity_filter[1], tick)},
      dither_{Dither(p, 0, tick), Dither(p, 1, tick)} {}

void MotorFeedback::start(const Joints<double>& planned_theta, const Joints<double>& measured_theta) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    difference_[j] = planned_theta[j] - quantised(measured_theta[j], p_.encoder.motor_counts[j]);
    error_velocity_[j].reset(motor_error(j), 0);
  }
}

void MotorFeedback::shift_plan(const Joints<double>& by) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double before = motor_error(j);
    difference_[j] += by[j];
    error_velocity_[j].shift(motor_error(j) - before);
  }
}

// Returns the whole difference if it exceeds half a count, not only the part beyond. So an arm that differs from the
// model follows the plan as closely as the resolution of the encoder permits.
double MotorFeedback::motor_error(const Parameters& p, std::size_t j, double difference) {
  const double half = count_angle(p.encoder.motor_counts[j]) / 2;
  return std::abs(difference) > half ? difference : 0;
}

double MotorFeedback::link_error(const Parameters& p, std::size_t j, double planned, double measured) {
  const double half = count_angle(p.encoder.link_counts[j]) / 2, of_motor = count_angle(p.encoder.motor_counts[j]) / 2;
  const double counted = quantised(measured, p.encoder.link_counts[j]);
  return std::clamp(beyond(planned - counted, half), -of_motor, of_motor);
}

double MotorFeedback::link_gain(const Parameters& p, std::size_t j) { return kLinkFraction * p.spring.stiffness[j]; }

bool MotorFeedback::link_says_it_rests(std::size_t j, double link_error, const Joints<double>& planned_velocity) const {
  const double count = count_angle(p_.encoder.motor_counts[j]);
  return planned_velocity == Joints<double>{} && std::abs(link_error) < count / 2 &&
         std::abs(difference_[j]) < 1.5 * count;
}

MotorFeedback::Command MotorFeedback::command(const Positions& planned, const Joints<double>& planned_velocity,
                                              const Positions& measured, const Joints<double>& feedforward,
                                              const Joints<bool>& blind, int ticks) {
  Command c{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    difference_[j] = planned.theta[j] - quantised(measured.theta[j], p_.encoder.motor_counts[j]);
    const double error = motor_error(j), error_velocity = error_velocity_[j].update(error, ticks);
    const double of_link = link_error(p_, j, planned.q[j], measured.q[j]);
    if (!blind[j]) c.feedback[j] = link_gain(p_, j) * of_link;
    if (!blind[j] && !link_says_it_rests(j, of_link, planned_velocity)) {
      c.feedback[j] += p_.feedback.position_gain[j] * error + p_.feedback.velocity_gain[j] * error_velocity;
    }
    const double wanted = feedforward[j] + dither_[j].next(planned_velocity[j]) + c.feedback[j];
    const double peak = p_.drive.peak_torque[j];
    c.torque[j] = std::clamp(wanted, -peak, peak);
    c.saturated |= std::abs(wanted) > peak;
  }
  return c;
}

TickController::TickController(const Parameters& p, const Trajectory& trajectory, double tick)
    : plan_(trajectory), tick_(tick), feedback_(p, tick) {
  const State<double>& start = trajectory.samples.front().state;
  feedback_.start(start.theta, start.theta);
}

TickController::Command TickController::command(double time, const MotorFeedback::Positions& measured) {
  const State<double> planned = plan_.at(time).state;
  return feedback_.command({planned.theta, planned.q}, planned.dtheta, measured, plan_.mean_torque(time, time + tick_));
}

}  // namespace fjr
