// The responses of a motor to constant torques, for the motor inertia procedure and its charts.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fjr {

struct Response {
  double u;                     // [N m]
  std::vector<double> time, y;  // since u was switched on; dtheta [rad/s], or theta [rad] from there
};

// The quantity that was measured.
enum class Measured { kVelocity, kPosition };

// The responses that were fitted together, and the residuals of their fit.
struct FittedResponses {
  Measured measured;
  std::vector<Response> all;  // without outliers
  Eigen::VectorXd residuals;  // of all responses, one after the other: fitted less measured, in the unit of y
};

}  // namespace fjr
