// Whether experiments agree with each other, and with the robot as it was known.
#pragma once

#include <string>
#include <vector>

#include "model/identify/estimate.h"
#include "model/parameters.h"

namespace fjr {

struct Identified;  // model/identify/arm.h

// In standard errors of their difference: two experiments that are further apart are worth a warning; one of them is
// wrong.
inline constexpr double kDoubtfulApart = 3, kContradictoryApart = 10;
// Times what was known: a factor of 1.5, less the noise of a log in which a column is in error by just that.
inline constexpr double kLargeChange = 1.45;

// One parameter that two logs on the same joint tell: of the same experiment, or of two, such as B, which is the slope
// of friction over speed (IV-E) and decides the final speed of a push (IV-F).
struct Agreement {
  std::string parameter;  // "viscous, joint 1"
  std::string unit;
  std::string first, second;  // the procedures; of the same one, with the logs
  double first_value = 0, first_error = 0, second_value = 0, second_error = 0;

  double standard_errors_apart() const;  // infinite where a value or an error is not a number
  std::string sentence() const;
};

// Of the parameters that several procedures, or several logs, have estimated: each pair of them.
std::vector<Agreement> agreements(const std::vector<Estimate>& estimates);

// A parameter that was known otherwise.
struct Change {
  std::string name;  // "motor.inertia[0]"
  double known = 0, found = 0, error = 0;

  bool is_large() const;  // beyond its error: kLargeChange or more either way, or of another sign
  std::string sentence() const;
};

// Of all that was identified; `known`: the robot before.
std::vector<Change> changes(const Parameters& known, const Identified& identified);

}  // namespace fjr
