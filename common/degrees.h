// Angles that were written in degrees where radians are meant.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

namespace fjr {

// "; angles are in rad, and 45 degrees are 0.785398 rad" behind a message that refuses an angle, where degrees would
// explain it: more than a whole turn, and within [lower, upper] if it is degrees. Otherwise "".
inline std::string degrees_suspected(double angle, double lower, double upper) {
  const double meant = angle * std::numbers::pi / 180;
  if (!(std::abs(angle) > 2 * std::numbers::pi) || meant < lower || meant > upper) return "";
  return fmt::format("; angles are in rad, and {} degrees are {:.6g} rad", angle, meant);
}

}  // namespace fjr
