// The tolerances of a certificate, beside exactness_tolerance().
#pragma once

#include <algorithm>

#include "model/parameters.h"
#include "planner/certificate/certificate.h"
#include "planner/control/motor_feedback.h"

namespace fjr {

// Feedback must stay below this fraction of the robot's torque limit: the plan moves the arm, not the feedback.
inline constexpr double kFeedbackFraction = 0.01;
// Published samples and what is between them: rounding only.
inline constexpr double kPublishedFraction = 1e-6;
// [s] least time over which rates of the torque are judged, by their mean, and half of the longest: half a tick of the
// executor, which commands means of the torque over whole ticks. Rows are closer to each other where the torque has a
// corner. If the torque goes to and fro within that time, at least half of the change is seen.
inline constexpr double kTorqueRateSpan = 0.5e-3;
// Fraction by which the rollout's velocities may exceed their limits, as the exactness tolerance explains.
inline constexpr double kRolloutVelocityFraction = 1e-3;

inline Joints<double> feedback_limit(const Parameters& p) {  // [N m]
  return {kFeedbackFraction * p.limits.torque[0], kFeedbackFraction * p.limits.torque[1]};
}

// One encoder count within 10 ms. [rad/s]
inline double link_velocity_tolerance(const Parameters& p) { return exactness_tolerance(p) / 0.01; }

// Two counts within 10 ms: an error of one count at 200 rad/s, three times the arm's highest natural frequency. [rad/s]
inline double rollout_velocity_tolerance(const Parameters& p) { return exactness_tolerance(p) / 0.005; }

// Velocity error that makes a tenth of the allowed feedback through the velocity gain, and no more than 0.01 rad/s,
// because with a small gain the feedback does not tell whether a velocity is true. [rad/s]
inline Joints<double> motor_velocity_tolerance(const Parameters& p) {
  constexpr double kMost = 0.01;
  const Joints<double> feedback = feedback_limit(p);
  Joints<double> tolerance;
  for (std::size_t j = 0; j < kJoints; ++j) {
    tolerance[j] = std::min(kMost, 0.1 * feedback[j] / p.feedback.velocity_gain[j]);
  }
  return tolerance;
}

// The same for the rollout against the dtheta columns, and what dither adds where the plan rests. Plans of the
// optimiser come to 2.6e-3 rad/s, where a motor passes through its friction step, however large the gain is; dither
// came to 1.1 of its amplitude.
inline Joints<double> rollout_motor_velocity_tolerance(const Parameters& p) {
  constexpr double kLeast = 5e-3;  // [rad/s]
  constexpr double kAmplitudes = 1.5;
  Joints<double> tolerance = motor_velocity_tolerance(p);
  for (std::size_t j = 0; j < kJoints; ++j) {
    tolerance[j] = std::max(kLeast, tolerance[j]) + kAmplitudes * Dither(p, j, kTick).amplitude();
  }
  return tolerance;
}

// What a motor's published velocity may change by beside what the model's accelerations at the rows make of it: at once
// (plans of the optimiser come to 1e-3 rad/s where they pass through a step of friction), and in time, as the allowed
// feedback torque would change it. Friction has a step within 5e-4 rad/s, so that larger jumps to and fro would hide
// jumps of the torque less friction.
inline constexpr double kUnexplainedVelocity = 2e-3;                   // [rad/s]
inline Joints<double> unexplained_acceleration(const Parameters& p) {  // [rad/s^2]
  const Joints<double> feedback = feedback_limit(p);
  return {feedback[0] / p.motor.inertia[0], feedback[1] / p.motor.inertia[1]};
}

}  // namespace fjr
