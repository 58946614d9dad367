// IV-C: a link swings freely on its spring, the motor held:
//
//   ddq + d dq + k (q - offset) + c z = 0,   dz/dt = (1 - z sgn dq)^n dq / width,   k = K/I, d = D/I, c = hysteresis /
//   I
//
// which is (9) for c = 0. Peaks give k and d by (10)-(14); from there the whole curve is fitted. The paper's own way
// ends at the peaks; a spring with hysteresis, though, is stiffer the less it swings, and that would end up in I. The
// hysteresis is Dahl's: n = 1 is also Bouc and Wen's model, n = 1/2 the Maxwell-slip model with evenly spread yields.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/dynamics.h"
#include "model/encoder.h"
#include "model/identify/checks.h"
#include "model/identify/figures.h"
#include "model/identify/fit.h"
#include "model/identify/procedures.h"
#include "model/input_error.h"

namespace fjr {
namespace {

struct Curve {
  std::vector<double> time, q;  // [s], [rad]
};

double resolution_of(double count) { return count / std::sqrt(12.0); }  // [rad]  standard deviation of rounding

struct Peak {
  std::size_t row;
  double time, height;  // above the mean position
};

constexpr double kSmallest = 0.06;  // of the largest peak: smaller ones are not used
constexpr std::size_t kFewestPeaks = 3;
constexpr double kLongestStep = 1e-3;  // [s]  of the simulated swing; the error per step is below 1e-9 of the swing
constexpr double kUnexplained = 2;     // times the encoder's own error: hysteresis is looked for above it

// Top of the parabola through the samples near the highest one: counts make several samples the highest.
Peak refine(const Curve& curve, std::size_t highest, std::size_t half_width) {
  const std::size_t from = highest > half_width ? highest - half_width : 0;
  const std::size_t to = std::min(highest + half_width + 1, curve.q.size());
  const auto m = static_cast<Eigen::Index>(to - from);
  Eigen::MatrixXd a(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t row = from + static_cast<std::size_t>(i);
    const double t = curve.time[row] - curve.time[highest];
    a.row(i) << 1, t, t * t;
    b[i] = curve.q[row];
  }
  const Eigen::VectorXd p = linear_fit(a, b).value;
  if (!(p[2] < 0)) return {highest, curve.time[highest], curve.q[highest]};
  const double t = -p[1] / (2 * p[2]);
  return {highest, curve.time[highest] + t, p[0] + t * (p[1] + t * p[2])};
}

// Wave crests: the highest sample of every stretch above a quarter of the last crest.
std::vector<Peak> crests(const Curve& curve) {
  const double largest = *std::max_element(curve.q.begin(), curve.q.end());
  std::vector<Peak> peaks;
  for (std::size_t row = 0; row < curve.q.size();) {
    const double threshold = 0.25 * (peaks.empty() ? largest : peaks.back().height);
    if (curve.q[row] < threshold) {
      ++row;
      continue;
    }
    std::size_t end = row, highest = row;
    for (; end < curve.q.size() && curve.q[end] >= 0; ++end) {
      if (curve.q[end] > curve.q[highest]) highest = end;
    }
    if (end < curve.q.size()) peaks.push_back(refine(curve, highest, std::max<std::size_t>((end - row) / 8, 2)));
    if (!peaks.empty() && peaks.back().height < kSmallest * largest) break;
    row = end + 1;
  }
  return peaks;
}

// The line (12) through the logarithms of the crests; its slope is all damping, hysteresis included.
Fit decrement_line(const std::vector<Peak>& peaks) {
  const auto m = static_cast<Eigen::Index>(peaks.size());
  Eigen::MatrixXd a(m, 2);
  Eigen::VectorXd logarithm(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Peak& peak = peaks[static_cast<std::size_t>(i)];
    a.row(i) << 1, peak.time;
    logarithm[i] = std::log(peak.height);
  }
  return linear_fit(a, logarithm);
}

// (12) and (14) from the crests: slope of their logarithm and time between them.
struct Decrement {
  double k, d;  // [1/s^2], [1/s]
};

Decrement decrement(const std::vector<Peak>& peaks) {
  const auto m = static_cast<Eigen::Index>(peaks.size());
  Eigen::MatrixXd line(m, 2);
  Eigen::VectorXd time(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    line.row(i) << 1, static_cast<double>(i);
    time[i] = peaks[static_cast<std::size_t>(i)].time;
  }
  const double sigma = -decrement_line(peaks).value[1];  // zeta omega_s (13)
  const double omega = 2 * std::numbers::pi / linear_fit(line, time).value[1];
  return {omega * omega + sigma * sigma, 2 * sigma};
}

// Of the fitted parameters; the last three only with hysteresis, the last only where n = 1 does not explain the curve.
enum Index { kQ, kDq, kOffset, kK, kD, kC, kWidth, kExponent };
constexpr Eigen::Index kPlain = kC, kWithHysteresis = kWidth + 1, kWithExponent = kExponent + 1;

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

// The curve begins at a crest reached from below: there the hysteresis is saturated, z = 1.
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

Fit better(const Fit& richer, const Fit& plain) {
  return richer.determined && richer.residual_rms < 0.9 * plain.residual_rms ? richer : plain;
}

// With hysteresis where the plain oscillator leaves more than the encoder explains, and only if that explains more.
Fit best_fit(const Curve& curve, const Fit& plain, double resolution) {
  if (plain.residual_rms < kUnexplained * resolution) return plain;
  Eigen::VectorXd start(kWithHysteresis);
  start << plain.value, 0.003 * plain.value[kK] * std::abs(plain.value[kQ]), 0.03 * std::abs(plain.value[kQ]);
  const Fit bouc_wen = better(fit_swing(curve, start), plain);
  if (bouc_wen.residual_rms < kUnexplained * resolution || bouc_wen.value.size() == kPlain) return bouc_wen;
  Eigen::VectorXd with_exponent(kWithExponent);
  with_exponent << bouc_wen.value, 0.7;
  return better(fit_swing(curve, with_exponent), bouc_wen);
}

Curve centred(const Log& log, int joint) {
  Curve curve{log.column("time"), log.column(joint_column("q", joint))};
  const double rest = median(curve.q);
  for (double& q : curve.q) q -= rest;
  return curve;
}

// Samples that jump out of their neighbourhood, here by half the swing, would be taken for crests.
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

std::vector<double> fitted_curve(const Curve& curve, const Fit& fit) {
  std::vector<double> q;
  for (std::size_t i = 0; i < curve.q.size(); ++i)
    q.push_back(curve.q[i] + fit.residuals[static_cast<Eigen::Index>(i)]);
  return q;
}

// The paper's logarithmic decrement: ln q_peak over time with its line (12), and the damping of the fitted curve, which
// is what remains without hysteresis.
Chart decrement_chart(const std::string& title, const std::vector<Peak>& peaks, const Fit& fit) {
  const Eigen::VectorXd line = decrement_line(peaks).value;
  const double viscous = -0.5 * fit.value[kD], middle = 0.5 * (peaks.front().time + peaks.back().time);
  Series measured{"ln q peak", kMeasuredColour, Style::kRings, {}, {}};
  Series all{fmt::format("line (12): {:.4f}/s", line[1]), kFittedColour, Style::kLine, {}, {}};
  Series damping{fmt::format("without hysteresis: {:.4f}/s", viscous), "#888", Style::kLine, {}, {}};
  for (const Peak& peak : peaks) {
    for (Series* s : {&measured, &all, &damping}) s->x.push_back(peak.time);
    measured.y.push_back(std::log(peak.height));
    all.y.push_back(line[0] + line[1] * peak.time);
    damping.y.push_back(line[0] + line[1] * middle + viscous * (peak.time - middle));
  }
  return {title + ", decrement", "time [s]", "ln(q peak / rad)", {measured, all, damping}};
}

std::vector<Chart> charts_of(int joint, const Curve& whole, const std::vector<Peak>& peaks, const Curve& decay,
                             const Fit& fit) {
  const std::string title = fmt::format("Fig. {}: free decay of link {}", 8 + joint, joint + 1);
  Series crests{"crests", kMeasuredColour, Style::kRings, {}, {}},
      envelope{"envelope (10)", "#888", Style::kLine, {}, {}};
  for (const Peak& peak : peaks) {
    crests.x.push_back(peak.time);
    crests.y.push_back(peak.height);
  }
  const Eigen::VectorXd line = decrement_line(peaks).value;
  for (int i = 0; i <= 100; ++i) {
    envelope.x.push_back(decay.time.front() + (decay.time.back() - decay.time.front()) * i / 100);
    envelope.y.push_back(std::exp(line[0] + line[1] * envelope.x.back()));
  }
  const Series fitted{"fit", kFittedColour, Style::kLine, decay.time, fitted_curve(decay, fit)};
  const Series measured{"measured", kResidualColour, Style::kDots, whole.time, whole.q};
  const Chart swing{title, "time [s]", "q [rad]", {crests, fitted, envelope, measured}};
  std::vector<double> residuals(fit.residuals.data(), fit.residuals.data() + fit.residuals.size());
  for (double& r : residuals) r = -r;
  return {swing, decrement_chart(title, peaks, fit),
          residual_chart(title, "time [s]", "residual [rad]", decay.time, std::move(residuals))};
}

std::vector<Peak> enough_crests(const Log& log, int joint, const Curve& curve) {
  std::vector<Peak> peaks = crests(curve);
  if (peaks.size() >= kFewestPeaks) return peaks;
  throw InputError(log.source, joint_column("q", joint),
                   fmt::format("{} wave crests; {} are needed", peaks.size(), kFewestPeaks));
}

struct Swung {
  Curve decay;  // without outliers
  Fit fit;
  std::size_t rejected;
};

Swung fit_decay(const Curve& whole, const std::vector<Peak>& peaks, const Decrement& start, double count) {
  Curve decay = between(whole, peaks.front().row, peaks.back().row + 1);
  Eigen::VectorXd p(kPlain);
  p << peaks.front().height, 0, 0, start.k, start.d;
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
  require_experiment(log, "link_inertia", joint);
  require_radians(log, joint);
  Estimate e;
  e.names = {"stiffness_over_inertia", "damping_over_inertia"};
  e.units = {"1/s^2", "1/s"};
  warn_of_gaps(log, e.warnings);

  const Curve raw = centred(log, joint), whole = without_spikes(raw);
  const std::vector<Peak> peaks = enough_crests(log, joint, whole);
  const Decrement start = decrement(peaks);
  const MassMatrix<double> m = mass_matrix(robot, 0.0);
  require_plausible(log, fmt::format("K/I of joint {} [1/s^2]", joint + 1), start.k,
                    robot.spring.stiffness[j] / (joint == 0 ? m.m11 : m.m22));
  const double count = count_angle(robot.encoder.link_counts[j]);
  const Swung swung = fit_decay(whole, peaks, start, count);
  const Fit& fit = swung.fit;
  warn_of_outliers(swung.rejected + raw.q.size() - whole.q.size(), "positions", e.warnings);

  e.value = fit.value.segment(kK, 2);
  e.covariance = fit.covariance.block(kK, kK, 2, 2);
  e.points = swung.decay.q.size();
  e.residual_rms = fit.residual_rms;
  e.residual_unit = "rad";
  e.r_squared = r_squared(swung.decay, fit);
  e.charts = charts_of(joint, whole, peaks, swung.decay, fit);
  if (fit.residual_rms > kUnexplained * resolution_of(count)) {
    e.warnings.push_back(
        fmt::format("the decay differs from a damped oscillation by {:.2g} rad, more than the encoder's "
                    "resolution explains",
                    fit.residual_rms));
  }
  warn_of_doubt(e);
  return e;
}

}  // namespace fjr
