#include "planner/ocp/rests.h"

#include <algorithm>
#include <cmath>

#include "planner/ocp/arm_collocation.h"

namespace fjr {
namespace {

// Velocities in multiples of the law's width: below kResting a motor counts as resting (tanh(2) is 0.96), above kMoving
// as moving.
constexpr double kResting = 2, kMoving = 6;

// Returns the velocity [rad/s] over which the law rises at zero: the width of the narrower of its two tanh terms.
double rising_width(const FrictionLaw& law) {
  return law.second_shape < 1 ? std::min(law.width, law.width / (1 - law.second_shape)) : law.width;
}

// Scales a resting motor's velocity from a law of width `before` to one of width `after`; keeps that of a moving motor.
double scaled(double velocity, double before, double after) {
  const double s = std::clamp((std::abs(velocity) / before - kResting) / (kMoving - kResting), 0.0, 1.0);
  const double moves = s * s * (3 - 2 * s);  // smooth from 0 to 1
  return velocity * (moves + (1 - moves) * after / before);
}

template <Features F>
void scale_rests(const Problem& problem, Collocated& solution, double width) {
  const auto t = arm_collocation::transcribe<F>(problem, solution.setup);
  Eigen::VectorXd& x = solution.report.iterate.x;
  for (int j = 0; j < kJoints; ++j) {
    const FrictionLaw law = FrictionLaw::of(problem.robot, j);
    const double before = rising_width(law.smoothed(solution.setup.smoothing.friction_width));
    const double after = rising_width(law.smoothed(width));
    for (int k = 0; k < t.intervals(); ++k) {
      for (int i = 0; i < t.scheme().stages(); ++i) {
        double& velocity = x(t.x_at(k, i) + kStateDtheta + j);
        if (t.x_at(k, i) != t.node_at(k)) velocity = scaled(velocity, before, after);
      }
    }
  }
}

}  // namespace

Collocated with_rests_scaled(const Problem& problem, Collocated solution, double width) {
  with_features(problem, [&]<Features F>() { scale_rests<F>(problem, solution, width); });
  return solution;
}

}  // namespace fjr
