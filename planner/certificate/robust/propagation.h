// Propagates deviations caused by uncertain parameters along a motion in the executor's closed loop, tick by tick.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/encoder.h"
#include "model/uncertainty.h"
#include "model/variational.h"
#include "planner/certificate/robust/sensitivities.h"
#include "planner/control/motor_feedback.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Two robots with one parameter a little larger and a little smaller, for differences.
struct Neighbours {
  Parameters more, less;
  double apart;

  // Derivative of a function f of the robot by that parameter.
  template <class F>
  auto slope(const F& f) const {
    return ((f(more) - f(less)) / apart).eval();
  }
};

Eigen::VectorXd vector_of(const State<double>& x);

// Record of one step, for the backward recursion (tracking_error.cc).
struct PropagatedPiece {
  double begin, end;              // [s]
  Eigen::MatrixXd before, after;  // sensitivities of the state, kStates x n
  Transition transition;
  Joints<double> swing;  // [rad/s] of the dither
};
struct PropagatedTick {
  std::vector<PropagatedPiece> pieces;
  Joints<double> motor_deviation, link_deviation;        // [rad] at its begin
  Joints<Eigen::RowVectorXd> error, error_before;        // d/dp of the motors' errors: in it, and in the tick before
  Joints<Eigen::RowVectorXd> velocity, velocity_before;  // of their filtered velocities
};

class Propagation {
 public:
  // The arguments have to outlive the object and its copies.
  Propagation(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty);

  // Propagates from one end of a tick to the other [s], with the torque held. record: filled in if it is not null.
  void pass(double from, double to, PropagatedTick* record = nullptr);

  const Eigen::MatrixXd& state() const { return state_; }
  const Eigen::MatrixXd& torque() const { return torque_; }

  const std::vector<Neighbours>& neighbours() const { return neighbours_; }
  const EquivalentGain& motor_gain(std::size_t j) const { return motors_[j]; }
  const EquivalentGain& link_gain(std::size_t j) const { return links_[j]; }
  Sample planned(double time) { return plan_.at(time); }

  // Returns the mean slope of the friction of motor j, divided by its inertia, between two velocities [rad/s], with the
  // dither's swing about them. [1/s]
  double mean_rate(std::size_t j, double from, double to, double swing) const;

 private:
  double deviation(Eigen::Index row) const;
  void feed_back(PropagatedTick* record);
  Eigen::MatrixXd by_parameters(const Sample& at) const;
  double mean_rate(std::size_t j, const Sample& begin, const Sample& end) const;
  bool is_steep(const Sample& begin, const Sample& end) const;
  void advance(double from, double to, PropagatedTick* record);

  const Parameters& robot_;
  Interpolator plan_;
  const Uncertainty& uncertainty_;
  std::vector<Neighbours> neighbours_;
  Eigen::Index count_;
  Eigen::MatrixXd state_, torque_;
  Joints<EquivalentGain> motors_, links_;
  Joints<Dither> dither_;
  Joints<double> swing_{};  // [rad/s] of the dither in this tick
  Joints<std::vector<VelocityFilter>> filters_;
  Joints<Eigen::RowVectorXd> error_, velocity_;  // of the last tick
};

}  // namespace fjr
