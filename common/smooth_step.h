// A step from 0 to 1 with two continuous derivatives.
#pragma once

namespace fjr {

// Returns 10 x^3 - 15 x^4 + 6 x^5 for x in [0, 1], 0 before and 1 after. This is the path of a minimum-jerk motion
// (Flash & Hogan, Journal of Neuroscience 5(7), 1985).
inline double smooth_step(double x) {
  if (x <= 0) return 0;
  return x >= 1 ? 1 : x * x * x * (10 + x * (-15 + 6 * x));
}

}  // namespace fjr
