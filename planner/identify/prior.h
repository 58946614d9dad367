// What is known of an arm before its motions are looked at.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/uncertainty.h"

namespace fjr {

// Errors of the parameters are factor times independent numbers of variance 1.
struct Prior {
  std::vector<std::string> names;
  std::vector<bool> assumed;  // its deviation is kUnknownFraction's, and not the robot file's
  Eigen::VectorXd deviation;
  Eigen::MatrixXd factor;
};

// The covariance of robot.yaml, its standard errors `widened` times as large. Parameters that have none there, and that
// ordinary motions usually tell, are given a weak one: kUnknownFraction of the value for stiffness, gravity torque,
// both inertias, viscous friction and its amplitude, kUnknownPayload for the payload's mass unless it is known. All
// others are kept as they are.
inline constexpr double kUnknownFraction = 0.2;
inline constexpr double kUnknownPayload = 0.5;  // [kg]
enum class PayloadMass {
  kUncertain,
  kKnown  // as the robot file has it: it cannot be told from link 2's own mass
};
Prior prior_of(const Parameters& robot, double widened = 1, PayloadMass payload = PayloadMass::kUncertain);

// Names of the parameters that ordinary motions usually tell: those that have such a weak one, the payload's mass last.
std::vector<std::string> usually_told(const Parameters& robot);

// Of a parameter by its name; empty where there is none.
std::string unit_of(const std::string& name);

}  // namespace fjr
