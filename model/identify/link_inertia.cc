// IV-C: the crests give K/I and D/I by (10)-(14), which are the start for a fit of the whole curve. The paper stops at
// the crests. But a spring with hysteresis is stiffer at smaller amplitudes, which would falsify I.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"
#include "model/dynamics.h"
#include "model/encoder.h"
#include "model/identify/checks.h"
#include "model/identify/crests.h"
#include "model/identify/procedures.h"
#include "model/identify/swing.h"

namespace fjr {
namespace {

constexpr std::size_t kFewestCrests = 3;

double resolution_of(double count) { return count / std::sqrt(12.0); }  // [rad]  standard deviation of rounding

Curve without_outliers(const Curve& curve, const Fit& fit, double floor) {
  const std::vector<bool> inside = inliers({fit.residuals.data(), curve.q.size()}, floor);
  Curve kept;
  for (std::size_t row = 0; row < curve.q.size(); ++row) {
    if (!inside[row]) continue;
    kept.time.push_back(curve.time[row]);
    kept.q.push_back(curve.q[row]);
  }
  return kept;
}

Curve centred(const Log& log, int joint) {
  Curve curve{log.column("time"), log.column(joint_column("q", joint))};
  const double rest = median(curve.q);
  for (double& q : curve.q) q -= rest;
  return curve;
}

// Removes samples that differ from their neighbours by half the amplitude, which would be mistaken for crests.
Curve without_spikes(const Curve& curve) {
  std::vector<double> smooth = curve.q;
  double amplitude = 0;
  for (std::size_t i = 2; i + 2 < curve.q.size(); ++i) {
    const auto at = curve.q.begin() + static_cast<std::ptrdiff_t>(i);
    smooth[i] = median({at - 2, at + 3});
    amplitude = std::max(amplitude, std::abs(smooth[i]));
  }
  Curve kept;
  for (std::size_t i = 0; i < curve.q.size(); ++i) {
    if (std::abs(curve.q[i] - smooth[i]) > 0.5 * amplitude) continue;
    kept.time.push_back(curve.time[i]);
    kept.q.push_back(curve.q[i]);
  }
  return kept;
}

Curve between(const Curve& curve, std::size_t from, std::size_t to) {
  const auto part = [&](const std::vector<double>& v) {
    return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(from),
                               v.begin() + static_cast<std::ptrdiff_t>(to));
  };
  return {part(curve.time), part(curve.q)};
}

double r_squared(const Curve& curve, const Fit& fit) {
  const Eigen::Map<const Eigen::VectorXd> q(curve.q.data(), static_cast<Eigen::Index>(curve.q.size()));
  return 1 - fit.residuals.squaredNorm() / (q.array() - q.mean()).square().sum();
}

std::vector<Crest> enough_crests(const Log& log, int joint, const Curve& curve) {
  std::vector<Crest> tops = crests(curve);
  if (tops.size() >= kFewestCrests) return tops;
  throw InputError(log.source, joint_column("q", joint),
                   fmt::format("{} wave crests; {} are needed", tops.size(), kFewestCrests));
}

struct Swung {
  Curve decay;  // without outliers
  Fit fit;
  std::size_t rejected;
};

Swung fit_decay(const Curve& whole, const std::vector<Crest>& tops, const Decrement& start, double count) {
  Curve decay = between(whole, tops.front().row, tops.back().row + 1);
  Eigen::VectorXd p(kPlain);
  p << tops.front().height, 0, 0, start.k, start.d;
  Fit plain = fit_swing(decay, p);
  const std::size_t before = decay.q.size();
  decay = without_outliers(decay, plain, std::max(3 * count, 4 * plain.residual_rms));
  if (decay.q.size() < before) plain = fit_swing(decay, plain.value);
  Fit fit = best_fit(decay, plain, resolution_of(count));
  allow_for_correlation(fit);
  const std::size_t rejected = before - decay.q.size();
  return {std::move(decay), std::move(fit), rejected};
}

}  // namespace

Estimate identify_link_inertia(const Log& log, int joint, const Parameters& robot) {
  const auto j = static_cast<std::size_t>(joint);
  require_radians(log, joint);
  Estimate e;
  e.names = {"stiffness_over_inertia", "damping_over_inertia"};
  e.units = {"1/s^2", "1/s"};
  warn_of_gaps(log, e.warnings);

  const Curve raw = centred(log, joint), whole = without_spikes(raw);
  const std::vector<Crest> tops = enough_crests(log, joint, whole);
  const Decrement start = decrement(tops);
  const MassMatrix<double> m = mass_matrix(robot, 0.0);
  require_plausible(log, fmt::format("K/I of joint {} [1/s^2]", joint + 1), start.k,
                    robot.spring.stiffness[j] / (joint == 0 ? m.m11 : m.m22));
  const double count = count_angle(robot.encoder.link_counts[j]);
  const Swung swung = fit_decay(whole, tops, start, count);
  const Fit& fit = swung.fit;
  warn_of_outliers(swung.rejected + raw.q.size() - whole.q.size(), "positions", e.warnings);

  e.value = fit.value.segment(kK, 2);
  e.covariance = fit.covariance.block(kK, kK, 2, 2);
  e.points = swung.decay.q.size();
  e.residual_rms = fit.residual_rms;
  e.residual_unit = "rad";
  e.r_squared = r_squared(swung.decay, fit);
  e.fitted = FittedDecay{whole, tops, decrement_line(tops).value, swung.decay, fit.residuals};
  if (is_unexplained(fit, resolution_of(count))) {
    e.warnings.push_back(
        fmt::format("the decay differs from a damped oscillation by {:.2g} rad, more than the encoder's "
                    "resolution explains",
                    fit.residual_rms));
  }
  warn_of_doubt(e);
  return e;
}

}  // namespace fjr
