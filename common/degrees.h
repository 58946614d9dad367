// Detects angles that were given in degrees instead of radians.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

namespace fjr {

// Returns "; angles are in rad, and 45 degrees are 0.785398 rad" to be appended to a message that refuses an angle, if
// degrees would explain it: the value exceeds a whole turn and is within [lower, upper] if taken as degrees. Otherwise
// returns "".
inline std::string degrees_suspected(double angle, double lower, double upper) {
  const double meant = angle * std::numbers::pi / 180;
  if (!(std::abs(angle) > 2 * std::numbers::pi) || meant < lower || meant > upper) return "";
  return fmt::format("; angles are in rad, and {} degrees are {:.6g} rad", angle, meant);
}

}  // namespace fjr
