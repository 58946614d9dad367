#include "planner/identify/planned_information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "model/dynamics.h"
#include "model/friction.h"
#include "model/variational.h"
#include "planner/control/motor_feedback.h"
#include "planner/identify/readings.h"

namespace fjr {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRateStep = 1e-4;  // relative step of a parameter to differentiate the model's rates

// Returns the motion as the executor will log it if it follows the plan exactly, without quantisation.
ExecutedMotion as_planned(const Trajectory& plan) {
  ExecutedMotion motion;
  Interpolator at(plan);
  const auto ticks = static_cast<long>(std::floor((plan.end_time() - plan.start_time()) / kTick + 1e-9));
  for (long k = 0; k <= ticks; ++k) {
    const double time = plan.start_time() + static_cast<double>(k) * kTick;
    const Sample row = at.at(time);
    motion.times.push_back(time);
    motion.q.push_back(row.state.q);
    motion.theta.push_back(row.state.theta);
    motion.torque.push_back(at.mean_torque(time, time + kTick));
    motion.planned_theta.push_back(row.state.theta);
  }
  return motion;
}

// Integrates the derivatives of the state by the initial state of a piece and by the parameters, along a plan.
class Variation {
 public:
  Variation(const Parameters& known, const Prior& prior) : known_(known) {
    for (Index i = 0; i < prior.factor.cols(); ++i) {
      const VectorXd by = kRateStep * prior.factor.col(i) /
                          prior.deviation.cwiseInverse().cwiseProduct(prior.factor.col(i)).cwiseAbs().maxCoeff();
      more_.push_back(moved(known, prior.names, by));
      less_.push_back(moved(known, prior.names, -by));
      apart_.push_back(2 * by.norm() / prior.factor.col(i).norm());
    }
  }

  void start(const Sample& begin) {
    at_ = begin;
    rates_ = rates(begin);
    by_start_.setIdentity();
    by_parameters_ = MatrixXd::Zero(kStates, static_cast<Index>(apart_.size()));
  }
  const StateMatrix& by_start() const { return by_start_; }
  const MatrixXd& by_parameters() const { return by_parameters_; }

  // Integrates dS/dt = A S + F over a tick with constant torque. A and F are those in the middle of the tick, except
  // that the slope of friction is averaged over the tick.
  void pass(const Sample& middle, const Sample& end, double duration) {
    StateMatrix a = state_jacobian(known_, middle.state, middle.torque);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto row = static_cast<Index>(kStateDtheta + j);
      const FrictionLaw law = FrictionLaw::of(known_, static_cast<int>(j));
      a(row, row) = -law.mean_slope(at_.state.dtheta[j], end.state.dtheta[j]) / known_.motor.inertia[j];
    }
    const MatrixXd rates_at_end = rates(end), forced = (rates_ + 4 * rates(middle) + rates_at_end) / 6;
    const Transition transition = transition_over(a, duration);
    by_start_ = transition.start * by_start_;
    by_parameters_ = transition.start * by_parameters_ + transition.input * forced;
    at_ = end;
    rates_ = rates_at_end;
  }

 private:
  MatrixXd rates(const Sample& at) const {
    MatrixXd all(kStates, static_cast<Index>(apart_.size()));
    for (std::size_t i = 0; i < apart_.size(); ++i) {
      State<double> above = dynamics<double>(more_[i], at.state, at.torque);
      const State<double> below = dynamics<double>(less_[i], at.state, at.torque);
      for (std::size_t k = 0; k < kStates; ++k) {
        all(static_cast<Index>(k), static_cast<Index>(i)) = (above[k] - below[k]) / apart_[i];
      }
    }
    return all;
  }

  const Parameters& known_;
  std::vector<Parameters> more_, less_;
  std::vector<double> apart_;  // distance of more_ and less_ in the prior's independent numbers
  Sample at_;                  // sample of the plan up to which it is integrated
  MatrixXd rates_;
  StateMatrix by_start_;
  MatrixXd by_parameters_;
};

// Eliminates the initial state by a Schur complement.
MatrixXd without_start(const MatrixXd& all, Index n) {
  const MatrixXd mixed = all.bottomLeftCorner(kStates, n);
  return all.topLeftCorner(n, n) - mixed.transpose() * all.bottomRightCorner<kStates, kStates>().ldlt().solve(mixed);
}

}  // namespace

MatrixXd planned_information(const Parameters& known, const Prior& prior, const Trajectory& plan) {
  const ExecutedMotion motion = as_planned(plan);
  const Eigen::Vector4d noise = count_deviation(known);
  const Index n = prior.factor.cols();
  Variation variation(known, prior);
  Interpolator at(plan);
  MatrixXd information = MatrixXd::Zero(n, n);
  for (const ReplayedPiece& piece : pieces_of(known, motion, 0)) {
    variation.start(at.at(motion.times[piece.first]));
    MatrixXd all = MatrixXd::Zero(n + kStates, n + kStates), row(4, n + kStates);
    for (std::size_t k = 0; k < piece.count; ++k) {
      const auto& s = variation.by_parameters();
      const auto& x = variation.by_start();
      row << s.topRows<2>(), x.topRows<2>(), s.middleRows<2>(kStateTheta), x.middleRows<2>(kStateTheta);
      all += row.transpose() * noise.cwiseAbs2().cwiseInverse().asDiagonal() * row;
      if (k + 1 == piece.count) break;
      const double now = motion.times[piece.first + k], next = motion.times[piece.first + k + 1];
      variation.pass(at.at(0.5 * (now + next)), at.at(next), next - now);
    }
    information += without_start(all, n);
  }
  return information;
}

}  // namespace fjr
