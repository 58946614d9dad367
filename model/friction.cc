#include "model/friction.h"

#include <limits>
#include <stdexcept>

namespace fjr {

bool FrictionLaw::increasing() const {
  if (!(slope(0) > 0)) return false;
  for (double v = width * 1e-7; v < width * 1e3; v *= 1.02) {
    if (!(slope(v) > 0)) return false;
  }
  return true;
}

double FrictionLaw::velocity(double torque_wanted) const {
  if (!increasing()) throw std::domain_error("friction law is not increasing: its inverse is not unique");
  // The law is odd and increasing, so the velocity is bracketed on a logarithmic scale and then found by bisection in
  // log(v) to the last bit.
  const double target = std::abs(torque_wanted);
  if (target == 0) return 0;
  double low = 0, high = width * 1e-8;
  while (torque(high) < target) {
    low = high;
    high *= 2;
  }
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (torque(middle) < target ? low : high) = middle;
  }
  return std::copysign(0.5 * (low + high), torque_wanted);
}

double FrictionLaw::unstable_band() const {
  if (slope(0) >= 0) return 0;
  constexpr double kRatio = 1.02;  // ratio of neighbouring velocities in the search for a sign change
  double inside = 0, outside = width * 1e-7;
  while (slope(outside) < 0) {
    inside = outside;
    outside *= kRatio;
    if (outside > 1e6 * width) return std::numeric_limits<double>::infinity();
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inside + outside);
    (slope(middle) < 0 ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace fjr
