#include "planner/certificate/robust/tracking_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/dynamics.h"
#include "planner/certificate/robust/propagation.h"
#include "planner/certificate/ticks.h"

namespace fjr {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;

// tr(S_q C S_q^T) [rad^2]
double squared_error(const MatrixXd& state, const MatrixXd& covariance) {
  const auto links = state.topRows<kJoints>();
  return (links * covariance).cwiseProduct(links).sum();
}

// Calls visit(begin, end) for the executor's ticks along it. [s]
template <class Visit>
void each_tick(const Trajectory& trajectory, Visit&& visit) {
  const double start = trajectory.start_time(), last = trajectory.end_time();
  for (long k = 0; k < tick_count(trajectory); ++k) {
    const double begin = start + static_cast<double>(k) * kTick;
    visit(begin, std::min(last, begin + kTick));
  }
}

// Number of inputs that describe a motion at an instant: states and compensated torques.
constexpr std::size_t kInputs = kStates + kJoints;

class Backwards {
 public:
  Backwards(const Parameters& robot, Propagation& forwards, const Uncertainty& uncertainty, double friction_reach)
      : robot_(robot), forwards_(forwards), covariance_(uncertainty.covariance), friction_reach_(friction_reach) {
    const Eigen::Index n = covariance_.rows();
    state_ = MatrixXd::Zero(kStates, n);
    for (std::size_t j = 0; j < kJoints; ++j) {
      law_[j] = FrictionLaw::of(robot, static_cast<int>(j));
      error_[j] = velocity_[j] = RowVectorXd::Zero(n);
    }
  }

  // Goes back over one tick to its beginning and appends its pieces of the gradient.
  void pass(const PropagatedTick& tick, std::vector<MotionPrice::Piece>& pieces) {
    const double begin = tick.pieces.front().begin, end = tick.pieces.back().end;
    const MatrixXd& after = tick.pieces.back().after;
    state_.topRows<kJoints>() += 2 * (end - begin) * after.topRows<kJoints>() * covariance_;
    double filters = 0;  // L^T times the change of the filters' states
    for (std::size_t j = 0; j < kJoints; ++j) {
      filters += error_[j].dot(tick.error[j] - tick.error_before[j]) +
                 velocity_[j].dot(tick.velocity[j] - tick.velocity_before[j]);
    }
    const double of_tick = squared_error(after, covariance_) + filters / (end - begin);
    MatrixXd torque = MatrixXd::Zero(kJoints, covariance_.rows());
    for (auto piece = tick.pieces.rbegin(); piece != tick.pieces.rend(); ++piece) {
      const double length = piece->end - piece->begin;
      const MatrixXd forced = piece->transition.input.transpose() * state_;
      const double change = state_.cwiseProduct(piece->after - piece->before).sum();
      pieces.push_back(by_motion(*piece, forced / length));
      pieces.back().density = of_tick + change / length;
      for (std::size_t j = 0; j < kJoints; ++j) {
        torque.row(static_cast<Eigen::Index>(j)) +=
            forced.row(static_cast<Eigen::Index>(kStateDtheta + j)) / robot_.motor.inertia[j];
      }
      state_ = piece->transition.start.transpose() * state_;
    }
    feed_back(tick, torque);
  }

 private:
  void feed_back(const PropagatedTick& tick, const MatrixXd& torque) {
    const MatrixXd& before = tick.pieces.front().before;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      const RowVectorXd by_torque = torque.row(row);
      const double keep = std::exp(-2 * std::numbers::pi * robot_.feedback.velocity_filter[j] * kTick);
      const RowVectorXd by_velocity = velocity_[j] + robot_.feedback.velocity_gain[j] * by_torque;
      const RowVectorXd by_difference = (1 - keep) / kTick * by_velocity;
      const RowVectorXd by_error = error_[j] + robot_.feedback.position_gain[j] * by_torque + by_difference;
      error_[j] = -by_difference;
      velocity_[j] = keep * by_velocity;
      through_gain(before.row(kStateTheta + row), -by_error, forwards_.motor_gain(j), tick.motor_deviation[j],
                   kStateTheta + row);
      through_gain(before.row(row), -MotorFeedback::link_gain(robot_, j) * by_torque, forwards_.link_gain(j),
                   tick.link_deviation[j], row);
    }
  }

  // Adds the derivative of y = g(d) s with d^2 = s C s^T. by_y: dP/dy.
  void through_gain(const RowVectorXd& s, const RowVectorXd& by_y, const EquivalentGain& gain, double deviation,
                    Eigen::Index row) {
    state_.row(row) += gain.at(deviation) * by_y;
    const double slope = gain.slope_at(deviation);
    if (slope != 0) state_.row(row) += slope * by_y.dot(s) / deviation * (s * covariance_);
  }

  // Returns a sample whose state or torque `input` is `value`; the compensated torque stays.
  Sample with(Sample sample, std::size_t input, double value) const {
    if (input >= kStates) {
      sample.torque[input - kStates] = value;
      return sample;
    }
    if (input >= kStateDtheta) {
      const std::size_t j = input - kStateDtheta;
      sample.torque[j] += law_[j].nonlinear(value) - law_[j].nonlinear(sample.state.dtheta[j]);
    }
    sample.state[input] = value;
    return sample;
  }

  // Returns sum_i L_i^T (df/dx S_i + df/dp_i), without the friction in df/dx, which is the mean over a piece.
  double weighted_rate(const Sample& at, const MatrixXd& weight, const MatrixXd& state) const {
    StateMatrix a = state_jacobian(robot_, at.state, at.torque);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto of_motor = static_cast<Eigen::Index>(kStateDtheta + j);
      a(of_motor, of_motor) = 0;
    }
    double sum = weight.cwiseProduct(a * state).sum();
    for (std::size_t i = 0; i < forwards_.neighbours().size(); ++i) {
      const Neighbours& n = forwards_.neighbours()[i];
      const auto more = dynamics<double>(n.more, at.state, at.torque),
                 less = dynamics<double>(n.less, at.state, at.torque);
      double slope = 0;
      for (std::size_t r = 0; r < kStates; ++r) {
        slope += weight(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i)) * (more[r] - less[r]);
      }
      sum += slope / n.apart;
    }
    return sum;
  }

  MotionPrice::Piece by_motion(const PropagatedPiece& piece, const MatrixXd& weight) {
    constexpr double kStep = 1e-4;  // [rad, rad/s, N m]
    const Sample begin = forwards_.planned(piece.begin), middle = forwards_.planned(0.5 * (piece.begin + piece.end)),
                 end = forwards_.planned(piece.end);
    const MatrixXd state = 0.5 * (piece.before + piece.after);
    MotionPrice::Piece of{piece.begin, piece.end, 0, {}, {}};
    for (std::size_t input = 0; input < kInputs; ++input) {
      const double value = input < kStates ? middle.state[input] : middle.torque[input - kStates];
      const double step = input >= kStateDtheta && input < kStates ? friction_reach_ : kStep;
      const double less = value - step, more = value + step;
      const double slope = (weighted_rate(with(middle, input, more), weight, state) -
                            weighted_rate(with(middle, input, less), weight, state)) /
                           (more - less);
      (input < kStates ? of.by_state[input] : of.by_torque[input - kStates]) = slope;
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Eigen::Index>(kStateDtheta + j);
      const auto rate = [&](double by) {
        return forwards_.mean_rate(j, begin.state.dtheta[j] + by, end.state.dtheta[j] + by, piece.swing[j]);
      };
      of.by_state[kStateDtheta + j] -= weight.row(row).dot(state.row(row)) *
                                       (rate(friction_reach_) - rate(-friction_reach_)) / (2 * friction_reach_);
    }
    return of;
  }

  const Parameters& robot_;
  Propagation& forwards_;
  const MatrixXd& covariance_;
  double friction_reach_;  // [rad/s]
  Joints<FrictionLaw> law_{};
  MatrixXd state_;                        // dP/dS
  Joints<RowVectorXd> error_, velocity_;  // dP by the states of the filters
};

}  // namespace

double expected_tracking_error(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty) {
  Propagation propagation(robot, trajectory, uncertainty);
  double sum = 0;
  each_tick(trajectory, [&](double begin, double end) {
    propagation.pass(begin, end);
    sum += (end - begin) * squared_error(propagation.state(), uncertainty.covariance);
  });
  return sum;
}

TrackingGradient tracking_gradient(const Parameters& robot, const Trajectory& trajectory,
                                   const Uncertainty& uncertainty, double friction_reach) {
  // The records of a tick for the backward recursion take up to 60 kB. So ticks are propagated again block by block,
  // from a copy at the beginning of each block.
  constexpr std::size_t kBlock = 250;
  struct Tick {
    double begin, end;  // [s]
  };
  Propagation forwards(robot, trajectory, uncertainty);
  TrackingGradient gradient;
  std::vector<Tick> ticks;
  std::vector<Propagation> blocks;
  each_tick(trajectory, [&](double begin, double end) {
    if (ticks.size() % kBlock == 0) blocks.push_back(forwards);
    ticks.push_back({begin, end});
    forwards.pass(begin, end);
    gradient.value += (end - begin) * squared_error(forwards.state(), uncertainty.covariance);
  });
  Backwards backwards(robot, forwards, uncertainty, friction_reach);
  for (; !blocks.empty(); blocks.pop_back()) {
    const std::size_t first = (blocks.size() - 1) * kBlock;
    std::vector<PropagatedTick> records(ticks.size() - first);
    for (std::size_t k = first; k < ticks.size(); ++k) {
      blocks.back().pass(ticks[k].begin, ticks[k].end, &records[k - first]);
    }
    for (auto record = records.rbegin(); record != records.rend(); ++record) backwards.pass(*record, gradient.pieces);
    ticks.resize(first);
  }
  std::reverse(gradient.pieces.begin(), gradient.pieces.end());
  return gradient;
}

}  // namespace fjr
