// The prior distribution of an arm's parameters, before its motions are evaluated.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/uncertainty.h"

namespace fjr {

// The errors of the parameters are `factor` times independent normal numbers of variance 1.
struct Prior {
  std::vector<std::string> names;
  std::vector<bool> assumed;  // whether its deviation is assumed (kUnknownFraction) and not from the robot file
  Eigen::VectorXd deviation;
  Eigen::MatrixXd factor;
};

// The prior is the covariance in robot.yaml, with standard errors `widened` times as large. Parameters without a
// standard error there that ordinary motions usually determine get a large one: kUnknownFraction of the value for
// stiffness, gravity torque, both inertias, viscous friction and its amplitude, and kUnknownPayload for the payload's
// mass unless it is known. All other parameters are fixed.
inline constexpr double kUnknownFraction = 0.2;
inline constexpr double kUnknownPayload = 0.5;  // [kg]
enum class PayloadMass {
  kUncertain,
  kKnown  // fixed as in the robot file, since it cannot be distinguished from link 2's own mass
};
Prior prior_of(const Parameters& robot, double widened = 1, PayloadMass payload = PayloadMass::kUncertain);

// Returns the names of the parameters that ordinary motions usually determine, with the payload's mass last.
std::vector<std::string> usually_told(const Parameters& robot);

// Returns the unit of a parameter by its name; empty if there is no such parameter.
std::string unit_of(const std::string& name);

}  // namespace fjr
