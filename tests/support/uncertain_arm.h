// The shipped arm, known with errors.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "model/parameters.h"
#include "model/uncertainty.h"

namespace fjr {

// Relative standard errors of some parameters, friction's in a correlated pair.
inline Parameters uncertain(Parameters p, double relative) {
  Uncertainty u;
  u.names = {"link.inertia[0]",     "link.gravity_torque[1]", "spring.stiffness[0]",  "spring.stiffness[1]",
             "friction.viscous[0]", "friction.amplitude[0]",  "friction.amplitude[1]"};
  const auto n = static_cast<Eigen::Index>(u.names.size());
  u.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double error = relative * *parameter_named(p, u.names[static_cast<std::size_t>(i)]);
    u.covariance(i, i) = error * error;
  }
  u.covariance(4, 5) = u.covariance(5, 4) = -0.8 * std::sqrt(u.covariance(4, 4) * u.covariance(5, 5));
  p.uncertainty = std::make_shared<const Uncertainty>(std::move(u));
  return p;
}

// Encoders that hide nothing.
inline Parameters with_fine_encoders(Parameters p) {
  p.encoder.motor_counts = p.encoder.link_counts = {1e9, 1e9};
  return p;
}

}  // namespace fjr
