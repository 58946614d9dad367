// An arm's parameters from ordinary motions that the executor ran.
#pragma once

#include <string>
#include <vector>

#include "common/parallel.h"
#include "planner/identify/prior.h"
#include "planner/identify/replay.h"

namespace fjr {

// A parameter of which less than this fraction of the prior's standard error is left was refined.
inline constexpr double kRefined = 0.5;

struct RefinedParameter {
  std::string name, unit;
  double before = 0, prior_error = 0;
  bool assumed = false;  // the prior's error is Prior's, not the robot file's
  double after = 0, error = 0;
  bool refined() const { return error < kRefined * prior_error; }
  double standard_errors_moved() const { return (after - before) / prior_error; }
};

// Readings of a motion off the arm under its torques, with each piece beginning where the readings want it: of the arm
// known before, and of the one found. rms of q1, q2, theta1, theta2. [rad]
struct Refit {
  Eigen::Vector4d before, after;
};

struct ExecutedFit {
  Parameters robot;  // `known` with the values after
  std::vector<RefinedParameter> parameters;
  Eigen::MatrixXd covariance;  // of them, in that order
  std::vector<Refit> motions;  // in the order of the logs
  double chi_square = 0;       // per degree of freedom
  long readings = 0;
  bool converged = true;
};

// The most likely parameters given the readings of all motions and the prior: least squares of readings off the arm
// under the logged torques, in standard deviations of a count, and of the parameters off the prior. Standard errors
// grow where the readings are off by more than counts, or neighbours alike. for_each: some hundred rollouts.
// Throws InputError where the motors hardly move, and where the arm that is known cannot be rolled out under the
// torques.
ExecutedFit fit_executed(const Parameters& known, const Prior& prior, const std::vector<ExecutedMotion>& motions,
                         const ForEach& for_each = one_after_another);

}  // namespace fjr
