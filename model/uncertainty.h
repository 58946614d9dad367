// The uncertainty of a robot's parameters: standard errors and covariance, as in robot.yaml.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "model/parameters.h"

namespace fjr {

class YamlNode;

// The errors of the parameters have mean zero and this covariance; parameters that are not named are known exactly.
// Only physical parameters of arm and motors can be uncertain: lengths, masses, springs, friction, payload. Limits,
// encoders, feedback and drives are chosen, and the radius of the links is a bound.
struct Uncertainty {
  std::vector<std::string> names;  // "spring.stiffness[0]", ..., "payload.mass", "payload.inertia"
  Eigen::MatrixXd covariance;      // of them, in this order, each in its own unit
  Payload payload{};               // the payload it refers to, if it names the payload

  bool none() const { return names.empty(); }
  double standard_error(std::size_t i) const;

  // Returns A (n x r) with A A^T = covariance, where r is its rank: the errors are A times r independent numbers of
  // variance 1. Covariances of an identification are singular, because for example a centre of mass is computed from a
  // gravity torque.
  Eigen::MatrixXd factor() const;
};

// Reads the uncertainty in a robot.yaml: `covariance` is one {names, matrix} or a list of such blocks, which are
// independent of each other; the standard errors of parameters that no block names are added to the diagonal. p: the
// parameters of the file. Errors of the links' inertia are converted to the points used by p, by the parallel axis
// theorem to first order. Throws InputError for unknown and repeated names, and for matrices that are not covariances.
Uncertainty read_uncertainty(const YamlNode& root, const Parameters& p);

// Returns the uncertainty of a robot with its payload. If it carries another payload than the one to which the
// covariance in robot.yaml refers, the entries about the payload are left out, and all others stay.
Uncertainty uncertainty_of(const Parameters& p);

// Returns the parameter of that name, or null if there is none.
double* parameter_named(Parameters& p, std::string_view name);

// Returns the robot with the named parameters changed by `change`. Masses that would become negative are set to 0.
Parameters changed(const Parameters& p, const std::vector<std::string>& names, const Eigen::VectorXd& change);

}  // namespace fjr
