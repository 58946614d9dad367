#include "planner/certificate/robust/sensitivities.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/dynamics.h"
#include "model/variational.h"
#include "planner/certificate/simulation.h"
#include "planner/certificate/ticks.h"
#include "planner/control/motor_feedback.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSteep = 0.1;        // of a motor's velocity, that friction takes in a tick
constexpr int kSteepPieces = 16;      // of such a tick
constexpr double kDifference = 0.01;  // of a standard error, by which parameters are moved to differentiate by them

VectorXd vector_of(const State<double>& x) {
  VectorXd v(kStates);
  x.copy_to(v.data());
  return v;
}

// A robot with one parameter a little larger and a little smaller.
struct Neighbours {
  Parameters more, less;
  double apart;

  template <class F>
  VectorXd slope(const F& f) const {
    return (f(more) - f(less)) / apart;
  }
};

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

// Mean slope of the friction of a motor that goes from one velocity to another at a steady acceleration, and swings
// about them by `swing`, as the executor's dither has it. [N m s/rad]
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

class Propagation {
 public:
  Propagation(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty)
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
    }
  }

  // From one end of a tick to the other, with the torque held. [s]
  void pass(double from, double to) {
    feed_back();
    const Sample begin = plan_.at(from), end = plan_.at(to);
    for (std::size_t j = 0; j < kJoints; ++j) {
      dither_[j].next(begin.state.dtheta[j]);
      swing_[j] = dither_[j].swing_tick() > 0 ? dither_[j].amplitude() : 0;
    }
    const int pieces = is_steep(begin, end) ? kSteepPieces : 1;
    for (int i = 0; i < pieces; ++i) {
      advance(from + (to - from) * i / pieces, from + (to - from) * (i + 1) / pieces);
    }
  }

  const MatrixXd& state() const { return state_; }
  const MatrixXd& torque() const { return torque_; }

 private:
  double deviation(Eigen::Index row) const {
    return std::sqrt(std::max(0.0, (state_.row(row) * uncertainty_.covariance * state_.row(row).transpose())(0)));
  }

  // The executor's law on deviations: a motor or a link that is ahead of the plan is an error to be taken back.
  void feed_back() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      const double of_motor = motors_[j].at(deviation(kStateTheta + row)), of_link = links_[j].at(deviation(row));
      for (Eigen::Index i = 0; i < count_; ++i) {
        const double error = -of_motor * state_(kStateTheta + row, i);
        torque_(row, i) = robot_.feedback.position_gain[j] * error +
                          robot_.feedback.velocity_gain[j] * filters_[j][static_cast<std::size_t>(i)].update(error) -
                          MotorFeedback::link_gain(robot_, j) * of_link * state_(row, i);
      }
    }
  }

  MatrixXd by_parameters(const Sample& at) const {
    MatrixXd slopes(kStates, count_);
    for (Eigen::Index i = 0; i < count_; ++i) {
      slopes.col(i) = neighbours_[static_cast<std::size_t>(i)].slope(
          [&](const Parameters& p) { return vector_of(dynamics<double>(p, at.state, at.torque)); });
    }
    return slopes;
  }

  double mean_rate(std::size_t j, const Sample& begin, const Sample& end) const {
    const FrictionLaw law = FrictionLaw::of(robot_, static_cast<int>(j));
    return mean_slope(law, begin.state.dtheta[j], end.state.dtheta[j], swing_[j]) / robot_.motor.inertia[j];
  }

  // Whether a motor passes through, or stays in, velocities at which friction is so steep that it does not stay the
  // same for a tick.
  bool is_steep(const Sample& begin, const Sample& end) const {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (std::abs(mean_rate(j, begin, end)) * kTick > kSteep) return true;
    }
    return false;
  }

  void advance(double from, double to) {
    const Sample begin = plan_.at(from), middle = plan_.at(0.5 * (from + to)), end = plan_.at(to);
    StateMatrix a = state_jacobian(robot_, middle.state, middle.torque);
    MatrixXd forced = (by_parameters(begin) + 4 * by_parameters(middle) + by_parameters(end)) / 6;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto of_motor = static_cast<Eigen::Index>(kStateDtheta + j);
      a(of_motor, of_motor) = -mean_rate(j, begin, end);
      forced.row(of_motor) += torque_.row(static_cast<Eigen::Index>(j)) / robot_.motor.inertia[j];
    }
    const Transition transition = transition_over(a, to - from);
    state_ = transition.start * state_ + transition.input * forced;
  }

  const Parameters& robot_;
  Interpolator plan_;
  const Uncertainty& uncertainty_;
  std::vector<Neighbours> neighbours_;
  Eigen::Index count_;
  MatrixXd state_, torque_;
  Joints<EquivalentGain> motors_, links_;
  Joints<Dither> dither_;
  Joints<double> swing_{};  // [rad/s] of the dither in this tick
  Joints<std::vector<VelocityFilter>> filters_;
};

}  // namespace

EquivalentGain::EquivalentGain(const Parameters& p, std::size_t joint, Encoder encoder) {
  constexpr int kPhases = 128, kErrors = 48;
  constexpr double kWidest = 4;  // standard deviations
  const bool of_motor = encoder == Encoder::kMotor;
  const double counts = of_motor ? p.encoder.motor_counts[joint] : p.encoder.link_counts[joint];
  const double count = count_angle(counts);
  const auto seen = [&](double planned, double error) {
    const double measured = planned + error;
    return of_motor ? MotorFeedback::motor_error(p, joint, planned - quantised(measured, counts))
                    : MotorFeedback::link_error(p, joint, planned, measured);
  };
  least_ = count / 64;
  for (int entry = 0; entry < kEntries; ++entry) {
    const double deviation = least_ * std::exp2(0.5 * entry);
    double along = 0, squared = 0;
    for (int k = 0; k < kErrors; ++k) {
      const double size = kWidest * (2 * (k + 0.5) / kErrors - 1), error = size * deviation;
      const double weight = std::exp(-0.5 * size * size);
      squared += weight * error * error * kPhases;
      for (int phase = 0; phase < kPhases; ++phase) {
        along -= weight * error * seen((phase + 0.5) / kPhases * count, error);
      }
    }
    gains_.push_back(along / squared);
  }
}

double EquivalentGain::at(double deviation) const {
  const double place = 2 * std::log2(std::max(deviation, least_) / least_);
  const double last = static_cast<double>(kEntries - 1);
  if (!(place < last)) return gains_.back();
  const auto before = static_cast<std::size_t>(place);
  const double beyond = place - static_cast<double>(before);
  return (1 - beyond) * gains_[before] + beyond * gains_[before + 1];
}

Sensitivities sensitivities(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty) {
  Sensitivities s;
  Propagation propagation(robot, trajectory, uncertainty);
  const double begin = trajectory.start_time(), end = trajectory.end_time();
  const long ticks = tick_count(trajectory);
  for (long k = 0; k < ticks; ++k) {
    const double now = begin + static_cast<double>(k) * kTick, next = std::min(end, now + kTick);
    propagation.pass(now, next);
    s.times.push_back(next);
    s.state.push_back(propagation.state());
    s.torque.push_back(propagation.torque());
  }
  return s;
}

}  // namespace fjr
