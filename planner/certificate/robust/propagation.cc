#include "planner/certificate/robust/propagation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/dynamics.h"
#include "planner/certificate/simulation.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSteep = 0.1;        // fraction of a motor's velocity that friction may take in a tick
constexpr int kSteepPieces = 16;      // into which such a tick is divided
constexpr double kDifference = 0.01;  // fraction of a standard error: step of differentiation by parameters

std::vector<Neighbours> neighbours_of(const Parameters& robot, const Uncertainty& uncertainty) {
  std::vector<Neighbours> all;
  for (std::size_t i = 0; i < uncertainty.names.size(); ++i) {
    const double step = kDifference * uncertainty.standard_error(i);
    Neighbours n{robot, robot, 2 * step};
    *parameter_named(n.more, uncertainty.names[i]) += step;
    *parameter_named(n.less, uncertainty.names[i]) -= step;
    all.push_back(std::move(n));
  }
  return all;
}

// Returns the mean slope [N m s/rad] of the friction of a motor that goes from one velocity to another at a steady
// acceleration, and oscillates about them by `swing` because of the executor's dither.
double mean_slope(const FrictionLaw& law, double from, double to, double swing) {
  constexpr int kPhases = 16;
  if (swing == 0) return law.mean_slope(from, to);
  double sum = 0;
  for (int i = 0; i < kPhases; ++i) {
    const double by = swing * std::sin(2 * std::numbers::pi * (i + 0.5) / kPhases);
    sum += law.mean_slope(from + by, to + by) / kPhases;
  }
  return sum;
}

}  // namespace

VectorXd vector_of(const State<double>& x) {
  VectorXd v(kStates);
  x.copy_to(v.data());
  return v;
}

Propagation::Propagation(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty)
    : robot_(robot),
      plan_(trajectory),
      uncertainty_(uncertainty),
      neighbours_(neighbours_of(robot, uncertainty)),
      count_(static_cast<Eigen::Index>(uncertainty.names.size())),
      state_(kStates, count_),
      torque_(kJoints, count_),
      motors_{EquivalentGain(robot, 0, EquivalentGain::Encoder::kMotor),
              EquivalentGain(robot, 1, EquivalentGain::Encoder::kMotor)},
      links_{EquivalentGain(robot, 0, EquivalentGain::Encoder::kLink),
             EquivalentGain(robot, 1, EquivalentGain::Encoder::kLink)},
      dither_{Dither(robot, 0, kTick), Dither(robot, 1, kTick)} {
  for (Eigen::Index i = 0; i < count_; ++i) {
    state_.col(i) = neighbours_[static_cast<std::size_t>(i)].slope(
        [&](const Parameters& p) { return vector_of(start_on(robot, p, trajectory)); });
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    VelocityFilter filter(robot.feedback.velocity_filter[j], kTick);
    filter.reset(0, 0);
    filters_[j].assign(uncertainty.names.size(), filter);
    error_[j] = velocity_[j] = Eigen::RowVectorXd::Zero(count_);
  }
}

void Propagation::pass(double from, double to, PropagatedTick* record) {
  feed_back(record);
  const Sample begin = plan_.at(from), end = plan_.at(to);
  for (std::size_t j = 0; j < kJoints; ++j) {
    dither_[j].next(begin.state.dtheta[j]);
    swing_[j] = dither_[j].swing_tick() > 0 ? dither_[j].amplitude() : 0;
  }
  const int pieces = is_steep(begin, end) ? kSteepPieces : 1;
  for (int i = 0; i < pieces; ++i) {
    advance(from + (to - from) * i / pieces, from + (to - from) * (i + 1) / pieces, record);
  }
}

double Propagation::deviation(Eigen::Index row) const {
  return std::sqrt(std::max(0.0, (state_.row(row) * uncertainty_.covariance * state_.row(row).transpose())(0)));
}

// Applies the executor's law to deviations: the feedback acts against a motor or a link that is ahead of the plan.
void Propagation::feed_back(PropagatedTick* record) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const double motor_deviation = deviation(kStateTheta + row), link_deviation = deviation(row);
    const double of_motor = motors_[j].at(motor_deviation), of_link = links_[j].at(link_deviation);
    const Eigen::RowVectorXd error_before = error_[j], velocity_before = velocity_[j];
    for (Eigen::Index i = 0; i < count_; ++i) {
      const double error = -of_motor * state_(kStateTheta + row, i);
      const double velocity = filters_[j][static_cast<std::size_t>(i)].update(error);
      torque_(row, i) = robot_.feedback.position_gain[j] * error + robot_.feedback.velocity_gain[j] * velocity -
                        MotorFeedback::link_gain(robot_, j) * of_link * state_(row, i);
      error_[j][i] = error;
      velocity_[j][i] = velocity;
    }
    if (record == nullptr) continue;
    record->motor_deviation[j] = motor_deviation;
    record->link_deviation[j] = link_deviation;
    record->error[j] = error_[j];
    record->error_before[j] = error_before;
    record->velocity[j] = velocity_[j];
    record->velocity_before[j] = velocity_before;
  }
}

MatrixXd Propagation::by_parameters(const Sample& at) const {
  MatrixXd slopes(kStates, count_);
  for (Eigen::Index i = 0; i < count_; ++i) {
    slopes.col(i) = neighbours_[static_cast<std::size_t>(i)].slope(
        [&](const Parameters& p) { return vector_of(dynamics<double>(p, at.state, at.torque)); });
  }
  return slopes;
}

double Propagation::mean_rate(std::size_t j, double from, double to, double swing) const {
  return mean_slope(FrictionLaw::of(robot_, static_cast<int>(j)), from, to, swing) / robot_.motor.inertia[j];
}

double Propagation::mean_rate(std::size_t j, const Sample& begin, const Sample& end) const {
  return mean_rate(j, begin.state.dtheta[j], end.state.dtheta[j], swing_[j]);
}

// Returns whether a motor passes through, or stays in, velocities at which friction is so steep that it changes within
// a tick.
bool Propagation::is_steep(const Sample& begin, const Sample& end) const {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (std::abs(mean_rate(j, begin, end)) * kTick > kSteep) return true;
  }
  return false;
}

void Propagation::advance(double from, double to, PropagatedTick* record) {
  const Sample begin = plan_.at(from), middle = plan_.at(0.5 * (from + to)), end = plan_.at(to);
  StateMatrix a = state_jacobian(robot_, middle.state, middle.torque);
  MatrixXd forced = (by_parameters(begin) + 4 * by_parameters(middle) + by_parameters(end)) / 6;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto of_motor = static_cast<Eigen::Index>(kStateDtheta + j);
    a(of_motor, of_motor) = -mean_rate(j, begin, end);
    forced.row(of_motor) += torque_.row(static_cast<Eigen::Index>(j)) / robot_.motor.inertia[j];
  }
  const Transition transition = transition_over(a, to - from);
  MatrixXd after = transition.start * state_ + transition.input * forced;
  if (record != nullptr) record->pieces.push_back({from, to, state_, after, transition, swing_});
  state_ = std::move(after);
}

}  // namespace fjr
