// Motor friction (24): the exact law, its smoothed family, and the inverse where the law is monotone.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/dual.h"
#include "model/parameters.h"

namespace fjr {

// The law of one joint, velocity v [rad/s] -> torque [N m].
//   tau(v) = B v + nonlinear(v),  nonlinear(v) = f tanh(v/eta) - f omega tanh(v/eta - h tanh(v/eta))      (24)
struct FrictionLaw {
  double viscous, amplitude, width, second_weight, second_shape;

  static FrictionLaw of(const Parameters& p, int joint) {
    const auto j = static_cast<std::size_t>(joint);
    return {p.friction.viscous[j], p.friction.amplitude[j], p.friction.width[j], p.friction.second_weight[j],
            p.friction.second_shape[j]};
  }

  template <class T>
  T nonlinear(const T& v) const {
    using std::tanh;
    const T s = v / width;
    const T first = tanh(s);
    return amplitude * first - amplitude * second_weight * tanh(s - second_shape * first);
  }

  // nonlinear(v) with its derivatives by v, in closed form: with s = v/eta, t = tanh s, a = s - h t, u = tanh a.
  struct Derivatives {
    double value, first, second;
  };
  Derivatives derivatives_of_nonlinear(double v) const {
    const double s = v / width;
    const double t = std::tanh(s), t1 = 1 - t * t, t2 = -2 * t * t1;
    const double a = s - second_shape * t, a1 = 1 - second_shape * t1, a2 = -second_shape * t2;
    const double u = std::tanh(a), u1 = 1 - u * u, u2 = -2 * u * u1;
    const double first = amplitude / width * (t1 - second_weight * u1 * a1);
    const double second = amplitude / (width * width) * (t2 - second_weight * (u2 * a1 * a1 + u1 * a2));
    return {amplitude * t - amplitude * second_weight * u, first, second};
  }
  template <CarriesValues D>
  D nonlinear(const D& v) const {
    const Derivatives of = derivatives_of_nonlinear(v.v);
    return chain(v, of.value, of.first, of.second);
  }

  template <class T>
  T torque(const T& v) const {
    return viscous * v + nonlinear(v);
  }

  // Returns a law of the same family without features narrower than about eps [rad/s] around v = 0; eps = 0 gives the
  // exact law. The first tanh gets the width sqrt(eta^2 + eps^2). The second keeps its far kink at the same velocity (h
  // eta, if h > 0), and its slope at zero, (1-h)/eta, is reduced to at most 1/eps by the same rule.
  FrictionLaw smoothed(double eps) const {
    FrictionLaw s = *this;
    if (eps <= 0) return s;
    s.width = std::hypot(width, eps);
    if (second_shape < 1) {
      const double narrow = std::hypot(width / (1 - second_shape), eps);
      s.second_shape = 1 - s.width / narrow;
    } else {
      s.second_shape = second_shape * width / s.width;
    }
    return s;
  }

  // Returns the velocity [rad/s] at which the complete law gives the torque [N m]. Throws std::domain_error unless the
  // law increases everywhere, as joint 1's does. Joint 2's law has three such velocities around zero and is unstable
  // there.
  double velocity(double torque_wanted) const;

  // Returns whether torque() increases everywhere, by scanning the slope over all velocity scales of the law.
  bool increasing() const;

  // Returns the half width [rad/s] of the band around rest in which the complete law falls with speed, from zero to its
  // first minimum. There rest is unstable: the velocity of a motor grows exponentially. Returns 0 for a law that
  // increases at rest, and infinity for one that never stops falling.
  double unstable_band() const;

  // Returns the mean of d torque / dv [N m s/rad] between two velocities, which is the effective slope over a tick if a
  // kink is narrower than the change of velocity.
  double mean_slope(double from, double to) const {
    constexpr double kApart = 1e-9;  // [rad/s] below it the difference is roundings
    return std::abs(to - from) > kApart ? (torque(to) - torque(from)) / (to - from) : slope(0.5 * (from + to));
  }

  // Returns d torque / dv [N m s/rad] at v.
  double slope(double v) const {
    const double s = v / width;
    const double first = std::tanh(s), dfirst = 1 - first * first;
    const double second = std::tanh(s - second_shape * first);
    return viscous + amplitude / width * (dfirst - second_weight * (1 - second * second) * (1 - second_shape * dfirst));
  }
};

}  // namespace fjr
