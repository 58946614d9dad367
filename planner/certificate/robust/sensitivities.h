// First-order sensitivities of a motion in the executor's closed loop.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "model/uncertainty.h"
#include "planner/trajectory/trajectory.h"

namespace fjr {

// How much of an encoder's error the feedback sees, on the average over arms whose errors have a standard deviation:
// E[x f(x)] / E[x^2] for normal x, with f what the executor takes for the error (motor_feedback.h), counts and dead
// zones included, and the plan anywhere within a count. Gelb & Vander Velde, Multiple-Input Describing Functions and
// Nonlinear System Design (1968), ch. 7: the gain of the linear element that errs least in the mean square.
class EquivalentGain {
 public:
  enum class Encoder { kMotor, kLink };
  EquivalentGain(const Parameters& p, std::size_t joint, Encoder encoder);

  // Of errors of this standard deviation. [rad] -> 1
  double at(double deviation) const;
  // Its derivative. [1/rad]
  double slope_at(double deviation) const;

 private:
  static constexpr int kEntries = 57;  // two a factor of two
  double least_;                       // [rad] deviation of the first
  std::vector<double> gains_;
};

struct Sensitivities {
  std::vector<double> times;            // [s] ends of the executor's ticks
  std::vector<Eigen::MatrixXd> state;   // dx/dp there, kStates x n, in the unit of a state by that of a parameter
  std::vector<Eigen::MatrixXd> torque;  // d tau_m/dp in the tick that ends there, kJoints x n
};

// Of the motion along the plan by the parameters that are uncertain, integrated with it tick by tick:
//   dS/dt = df/dx S + df/dp + df/dtau dtau/dp,   S(0) = d(start)/dp,
// where dtau/dp is the executor's feedback on S, held for the tick, with equivalent gains for the encoders of the
// deviation that S and the covariance say. The plan's rows are taken for the motion of the robot itself.
Sensitivities sensitivities(const Parameters& robot, const Trajectory& trajectory, const Uncertainty& uncertainty);

}  // namespace fjr
