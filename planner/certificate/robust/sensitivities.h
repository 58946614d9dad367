// First-order sensitivities of a motion in the executor's closed loop.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "model/uncertainty.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// Fraction of an encoder's error that the feedback sees, averaged over arms whose errors have a standard deviation: E[x
// f(x)] / E[x^2] for normal x, where f(x) is the error that the executor's feedback uses (motor_feedback.h), counts and
// dead zones included, with the plan anywhere within a count. It is the gain of the linear element with the least mean
// square error: Gelb & Vander Velde, Multiple-Input Describing Functions and Nonlinear System Design (1968), ch. 7.
class EquivalentGain {
 public:
  enum class Encoder { kMotor, kLink };
  EquivalentGain(const Parameters& p, std::size_t joint, Encoder encoder);

  // Returns the gain for errors of this standard deviation. [rad] -> 1
  double at(double deviation) const;
  // Returns its derivative by the deviation. [1/rad]
  double slope_at(double deviation) const;

 private:
  static constexpr int kEntries = 57;  // two for each factor of two in the deviation
  double least_;                       // [rad] deviation of the first
  std::vector<double> gains_;
};

struct Sensitivities {
  std::vector<double> times;            // [s] ends of the executor's ticks
  std::vector<Eigen::MatrixXd> state;   // dx/dp there, kStates x n, in the unit of a state by that of a parameter
  std::vector<Eigen::MatrixXd> torque;  // d tau_m/dp in the tick that ends there, kJoints x n
};

// Returns the sensitivities of the motion to the uncertain parameters, integrated along the plan tick by tick:
//   dS/dt = df/dx S + df/dp + df/dtau dtau/dp,   S(0) = d(start)/dp,
// where dtau/dp is the executor's feedback on S, held for the tick, with the encoders' equivalent gains for the
// deviation that follows from S and the covariance. The plan's rows are taken for the motion of the robot itself.
Sensitivities sensitivities(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty);

}  // namespace fjr
