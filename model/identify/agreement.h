// Checks whether experiments agree with each other, and with the robot known before.
#pragma once

#include <string>
#include <vector>

#include "model/identify/estimate.h"
#include "model/parameters.h"

namespace fjr {

struct Identified;  // model/identify/arm.h

// Differences of two experiments in standard errors of the difference. Beyond the first a warning is given; beyond the
// second one of them must be wrong.
inline constexpr double kDoubtfulApart = 3, kContradictoryApart = 10;
// Ratio to the known value, or its inverse, that counts as a large change, unless the change is within kDoubtfulApart
// standard errors. It detects a column that is wrong by a factor of 1.5, in spite of the noise of the log.
inline constexpr double kLargeChange = 1.45;

// A parameter that was estimated from two logs on the same joint. They may be of the same experiment or of different
// ones: B, for example, is the slope of friction over speed (IV-E) and determines the final speed of a push (IV-F).
struct Agreement {
  std::string parameter;  // "viscous, joint 1"
  std::string unit;
  std::string first, second;  // names of the procedures, with the logs if they are equal
  double first_value = 0, first_error = 0, second_value = 0, second_error = 0;

  double standard_errors_apart() const;  // infinite where a value or an error is not a number
  std::string sentence() const;
};

// Compares every pair of estimates of the same parameter by several procedures or logs.
std::vector<Agreement> agreements(const std::vector<Estimate>& estimates);

// A parameter with its identified and its known value, which may be equal.
struct Change {
  std::string name;  // "motor.inertia[0]"
  double known = 0, found = 0, error = 0;

  bool is_large() const;  // beyond its error: kLargeChange or more either way, or of another sign
  std::string sentence() const;
};

// Returns the changes of all identified parameters with respect to the robot `known` before.
std::vector<Change> changes(const Parameters& known, const Identified& identified);

}  // namespace fjr
