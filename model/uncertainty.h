// How well a robot's parameters are known: standard errors and covariance, as robot.yaml has them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "model/parameters.h"

namespace fjr {

class YamlNode;

// The errors of the parameters have mean zero and this covariance; what is not named is known exactly. Of the arm and
// its motors only: lengths, masses, springs, friction, the payload. Limits, encoders, feedback and drives are chosen,
// and the links' radius is a bound.
struct Uncertainty {
  std::vector<std::string> names;  // "spring.stiffness[0]", ..., "payload.mass", "payload.inertia"
  Eigen::MatrixXd covariance;      // of them, in this order, each in its own unit
  Payload payload{};               // that it is about, where it names the payload

  bool none() const { return names.empty(); }
  double standard_error(std::size_t i) const;

  // n x r with A A^T = covariance and r its rank: errors are A times r independent numbers of variance 1. An
  // identification's covariances are singular, for it tells, say, a centre of mass by a gravity torque.
  Eigen::MatrixXd factor() const;
};

// Of a robot.yaml: `covariance`, one {names, matrix} or a list of such blocks, which have nothing to do with each
// other; on the diagonal, the standard errors of what no block names. p: its entries. Errors of the links' inertia are
// about the points that p has them about, by the parallel axis theorem to first order. Throws InputError for unknown
// and repeated names, and for what is no covariance.
Uncertainty read_uncertainty(const YamlNode& root, const Parameters& p);

// A robot's, with that of its payload. Where it carries another one than robot.yaml's covariance is about, what that
// says of the payload is left out, and of everything else stays.
Uncertainty uncertainty_of(const Parameters& p);

// The parameter of that name; null where there is none.
double* parameter_named(Parameters& p, std::string_view name);

// The robot whose parameters differ by `change`, in the order of the names. A mass that would be negative is 0.
Parameters changed(const Parameters& p, const std::vector<std::string>& names, const Eigen::VectorXd& change);

}  // namespace fjr
