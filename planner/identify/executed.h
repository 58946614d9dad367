// Identifies an arm's parameters from ordinary motions that the executor ran.
#pragma once

#include <string>
#include <vector>

#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/identify/replay.h"

namespace fjr {

// A parameter counts as refined if its standard error is less than this fraction of the prior's.
inline constexpr double kRefined = 0.5;

struct RefinedParameter {
  std::string name, unit;
  double before = 0, prior_error = 0;
  bool assumed = false;  // the prior error is an assumption (Prior::assumed) and not from the robot file
  double after = 0, error = 0;
  bool refined() const { return error < kRefined * prior_error; }
  double standard_errors_moved() const { return (after - before) / prior_error; }
};

// rms residuals [rad] of the encoders q1, q2, theta1, theta2 in one motion, between the readings and the simulated arm
// under the logged torques, with the best initial state of each piece: for the arm known before, and for the one found.
struct Refit {
  Eigen::Vector4d before, after;
};

struct ExecutedFit {
  Parameters robot;  // `known` with the identified values
  std::vector<RefinedParameter> parameters;
  Eigen::MatrixXd covariance;  // of the parameters, in the same order
  std::vector<Refit> motions;  // in the order of the logs
  double chi_square = 0;       // per degree of freedom
  long readings = 0;
  bool converged = true;
};

// Returns the maximum a posteriori parameters given the readings of all motions and the prior. It minimises the squares
// of the residuals between readings and simulated arm, in standard deviations of a count, plus those of the parameters'
// deviations from the prior. The standard errors are increased if residuals exceed the quantisation or are correlated.
// for_each runs some hundred rollouts. Throws InputError if the motors hardly move, or if the known arm cannot be
// simulated under the torques.
ExecutedFit fit_executed(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
                         const ForEach& for_each = one_after_another);

}  // namespace fjr
