#include "model/identify/swing.h"

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

constexpr double kLongestStep = 1e-3;  // [s]  of the simulated swing; the error per step is below 1e-9 of the swing
constexpr double kUnexplained = 2;     // ratio of residual to encoder error above which hysteresis is fitted

struct Swing {
  double q, dq, z;
};

double hysteresis_slope(const Eigen::VectorXd& p, const Swing& s) {
  if (p.size() == kPlain) return 0;
  const double ahead = std::max(1 - s.z * std::copysign(1.0, s.dq), 0.0);
  return (p.size() == kWithExponent ? std::pow(ahead, std::max(p[kExponent], 0.0)) : ahead) / p[kWidth];
}

Swing derivative(const Eigen::VectorXd& p, const Swing& s) {
  const double c = p.size() == kPlain ? 0 : p[kC];
  return {s.dq, -p[kD] * s.dq - p[kK] * (s.q - p[kOffset]) - c * s.z, hysteresis_slope(p, s) * s.dq};
}

Swing moved(const Swing& s, const Swing& f, double h) { return {s.q + h * f.q, s.dq + h * f.dq, s.z + h * f.z}; }

Swing runge_kutta_4(const Eigen::VectorXd& p, const Swing& s, double h) {
  const Swing k1 = derivative(p, s), k2 = derivative(p, moved(s, k1, h / 2));
  const Swing k3 = derivative(p, moved(s, k2, h / 2)), k4 = derivative(p, moved(s, k3, h));
  return moved(
      s, {k1.q + 2 * k2.q + 2 * k3.q + k4.q, k1.dq + 2 * k2.dq + 2 * k3.dq + k4.dq, k1.z + 2 * k2.z + 2 * k3.z + k4.z},
      h / 6);
}

// The curve begins at a crest reached from below, where the hysteresis is saturated (z = 1).
void simulate(const Eigen::VectorXd& p, const Curve& curve, Eigen::VectorXd& q) {
  Swing s{p[kQ], p[kDq], 1};
  q[0] = s.q;
  for (std::size_t row = 1; row < curve.time.size(); ++row) {
    const double interval = curve.time[row] - curve.time[row - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(interval / kLongestStep - 1e-6)));
    for (int i = 0; i < steps; ++i) s = runge_kutta_4(p, s, interval / steps);
    q[static_cast<Eigen::Index>(row)] = s.q;
  }
}

Fit better(const Fit& richer, const Fit& plain) {
  return richer.determined && richer.residual_rms < 0.9 * plain.residual_rms ? richer : plain;
}

}  // namespace

Fit fit_swing(const Curve& curve, const Eigen::VectorXd& start) {
  const auto size = static_cast<Eigen::Index>(curve.q.size());
  const Eigen::Map<const Eigen::VectorXd> measured(curve.q.data(), size);
  return curve_fit(
      [&](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
        simulate(p, curve, r);
        r -= measured;
      },
      size, start);
}

bool is_unexplained(const Fit& fit, double resolution) { return fit.residual_rms > kUnexplained * resolution; }

Fit best_fit(const Curve& curve, const Fit& plain, double resolution) {
  if (!is_unexplained(plain, resolution)) return plain;
  Eigen::VectorXd start(kWithHysteresis);
  start << plain.value, 0.003 * plain.value[kK] * std::abs(plain.value[kQ]), 0.03 * std::abs(plain.value[kQ]);
  const Fit bouc_wen = better(fit_swing(curve, start), plain);
  if (!is_unexplained(bouc_wen, resolution) || bouc_wen.value.size() == kPlain) return bouc_wen;
  Eigen::VectorXd with_exponent(kWithExponent);
  with_exponent << bouc_wen.value, 0.7;
  return better(fit_swing(curve, with_exponent), bouc_wen);
}

}  // namespace fjr
