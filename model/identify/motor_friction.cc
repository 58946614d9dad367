// IV-E: the friction law (24) through the average torques at constant speeds.
//
//   tau(v) = B v + f tanh(v/eta) - g tanh(v/eta - h tanh(v/eta)),   g = f omega
//
// For given (eta, h) it is linear in (B, f, g): a grid over those two with linear fits finds every sensible start, and
// the best few are finished by nonlinear least squares. eta > 0, for (-f, -eta, omega, h) is the same law.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/friction.h"
#include "model/identify/checks.h"
#include "model/identify/figures.h"
#include "model/identify/fit.h"
#include "model/identify/procedures.h"
#include "model/identify/stretches.h"
#include "model/identify/velocity.h"
#include "model/input_error.h"

namespace fjr {
namespace {

struct Point {
  double v, tau;              // [rad/s], [N m]
  double sigma_v, sigma_tau;  // standard errors of these averages
};

constexpr std::size_t kFewestRows = 8, kFewestSpeeds = 8;
constexpr double kShortest = 0.2;       // [s]  of a constant speed that nobody commands
constexpr double kStanding = 1;         // standard errors of the speed: below that the motor may as well stand
constexpr double kSkipped = 0.2;        // of each constant speed, for its transient
constexpr std::size_t kFinished = 4;    // starts
constexpr double kChiSquare95 = 3.841;  // one degree of freedom
constexpr double kLargestShape = 1e5;   // |h| beyond which nobody could measure
constexpr double kWidestKnown = 0.3;    // relative standard error of h - 1 up to which linear theory is believed
constexpr double kSharpExcluded = 25;   // by five standard deviations
constexpr double kExact = 0.1;          // a reduced chi^2 below this: the points have no noise of their own to tell

// Where dtheta<joint>_plan, the commanded speed, is constant; where nobody commands, where speed and torque are.
std::vector<Stretch> constant_speeds(const Log& log, int joint, const Parameters& robot) {
  const std::string planned = joint_column("dtheta", joint, "_plan");
  if (log.has(planned)) return commanded_stretches(log.column(planned));
  const auto rows = static_cast<std::size_t>(kShortest / sample_interval(log));
  return steady_stretches({velocity(log, joint, robot, rows / 4), {log.column(joint_column("tau", joint)), 0}},
                          std::max(rows, kFewestRows));
}

std::vector<Point> averages(const Log& log, int joint, const Parameters& robot, std::vector<std::string>& warnings) {
  const std::vector<double>& tau = log.column(joint_column("tau", joint));
  std::vector<Point> points;
  std::size_t rejected = 0;
  const std::vector<Stretch> stretches = constant_speeds(log, joint, robot);
  require_consistent_velocity(log, joint, robot, stretches);
  for (Stretch stretch : stretches) {
    stretch.from += static_cast<std::size_t>(kSkipped * static_cast<double>(stretch.rows()));
    if (stretch.rows() < kFewestRows) continue;
    const Speed speed = constant_speed(log, joint, robot, stretch);
    if (std::abs(speed.mean) <= kStanding * speed.standard_error) continue;
    const Average torque = robust_mean(std::span(tau).subspan(stretch.from, stretch.rows()));
    rejected += speed.rejected + torque.rejected;
    points.push_back({speed.mean, torque.mean, speed.standard_error, torque.standard_error});
  }
  warn_of_outliers(rejected, "samples", warnings);
  if (points.size() < kFewestSpeeds) {
    throw InputError(log.source, joint_column("dtheta", joint),
                     fmt::format("{} constant speeds; at least {} are needed", points.size(), kFewestSpeeds));
  }
  return points;
}

enum Index { kB, kF, kLogEta, kG, kAsinhH, kAll };

// h; where the points do not determine it, the search would run away.
double shape(const Eigen::VectorXd& p) { return std::clamp(std::sinh(p[kAsinhH]), -kLargestShape, kLargestShape); }

FrictionLaw law_of(const Eigen::VectorXd& p) { return {p[kB], p[kF], std::exp(p[kLogEta]), p[kG] / p[kF], shape(p)}; }

// tau of the law, without dividing by f.
double torque(const Eigen::VectorXd& p, double v) {
  const double s = v / std::exp(p[kLogEta]), first = std::tanh(s);
  return p[kB] * v + p[kF] * first - p[kG] * std::tanh(s - shape(p) * first);
}

// Standard deviation of a point around the law: the torque's own, and the speed's by the law's slope.
std::vector<double> deviations(const std::vector<Point>& points, const FrictionLaw* law) {
  double range = 0;
  for (const Point& point : points) range = std::max(range, std::abs(point.tau));
  std::vector<double> sigma;
  for (const Point& point : points) {
    const double by_speed = law == nullptr ? 0 : law->slope(point.v) * point.sigma_v;
    sigma.push_back(std::max(std::hypot(point.sigma_tau, by_speed), 1e-6 * range));
  }
  return sigma;
}

Eigen::VectorXd start_at(const std::vector<Point>& points, const std::vector<double>& sigma, double eta, double h,
                         double& cost) {
  const auto m = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd a(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Point& point = points[static_cast<std::size_t>(i)];
    const double s = point.v / eta, first = std::tanh(s), weight = 1 / sigma[static_cast<std::size_t>(i)];
    a.row(i) << weight * point.v, weight * first, -weight * std::tanh(s - h * first);
    b[i] = weight * point.tau;
  }
  const Fit fit = linear_fit(a, b);
  Eigen::VectorXd p(static_cast<Eigen::Index>(kAll));
  p << fit.value[0], fit.value[1], std::log(eta), fit.value[2], std::asinh(h);
  const bool physical = fit.determined && fit.value[0] > 0 && fit.value[1] > 0;
  cost = physical ? fit.residuals.squaredNorm() : HUGE_VAL;
  return p;
}

// Nonlinear least squares from `p`, with h free or kept.
Fit finish(const std::vector<Point>& points, const std::vector<double>& sigma, const Eigen::VectorXd& p, bool fix_h) {
  const auto size = static_cast<Eigen::Index>(points.size());
  const Eigen::Index free = fix_h ? kAsinhH : kAll;
  const double h = p[kAsinhH];
  Fit fit = curve_fit(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        Eigen::VectorXd all(static_cast<Eigen::Index>(kAll));
        all.head(free) = x;
        if (fix_h) all[kAsinhH] = h;
        for (Eigen::Index i = 0; i < size; ++i) {
          const Point& point = points[static_cast<std::size_t>(i)];
          r[i] = (torque(all, point.v) - point.tau) / sigma[static_cast<std::size_t>(i)];
        }
      },
      size, p.head(free));
  if (fix_h) {
    fit.value.conservativeResize(kAll);
    fit.value[kAsinhH] = h;
    fit.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(kAll, kAll));
  }
  return fit;
}

bool physical(const Eigen::VectorXd& p) { return p.allFinite() && p[kB] >= 0 && p[kF] > 0; }

Fit best_of_many_starts(const Log& log, const std::vector<Point>& points, const std::vector<double>& sigma) {
  double slowest = HUGE_VAL, fastest = 0;
  for (const Point& point : points) {
    slowest = std::min(slowest, std::abs(point.v));
    fastest = std::max(fastest, std::abs(point.v));
  }
  std::vector<std::pair<double, Eigen::VectorXd>> starts;
  for (double eta = std::max(slowest, 1e-3 * fastest); eta <= fastest; eta *= 1.25) {
    for (double size = 0.1; size < kLargestShape; size *= 1.3) {
      for (const double h : {size, -size}) {
        double cost = 0;
        Eigen::VectorXd p = start_at(points, sigma, eta, h, cost);
        if (std::isfinite(cost)) starts.emplace_back(cost, std::move(p));
      }
    }
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Fit best;
  double cost = HUGE_VAL;
  std::size_t finished = 0;
  const Eigen::VectorXd* last = nullptr;
  for (const auto& [unused, p] : starts) {
    // Neighbours on the grid end in the same minimum.
    if (last != nullptr && std::abs(p[kLogEta] - (*last)[kLogEta]) < 0.3 && p[kAsinhH] * (*last)[kAsinhH] > 0 &&
        std::abs(p[kAsinhH] - (*last)[kAsinhH]) < 0.5) {
      continue;
    }
    if (finished++ == kFinished) break;
    last = &p;
    Fit fit = finish(points, sigma, p, false);
    if (!physical(fit.value) || !(fit.residuals.squaredNorm() < cost)) continue;
    cost = fit.residuals.squaredNorm();
    best = std::move(fit);
  }
  if (!std::isfinite(cost))
    throw InputError(log.source, "",
                     fmt::format("no friction law with positive f and B fits these torques at {:.3g} to {:.3g} rad/s",
                                 slowest, fastest));
  return best;
}

// Residuals are in standard errors of the points, which the samples themselves tell: that the points happen to lie
// closer to the law than these allow makes it no more certain; that they lie farther off does make it less so.
void never_below_the_points(Fit& fit) {
  const double degrees = static_cast<double>(std::max<Eigen::Index>(fit.residuals.size() - kAll, 1));
  const double reduced_chi_square = fit.residuals.squaredNorm() / degrees;
  if (reduced_chi_square < 1 && reduced_chi_square > kExact) fit.covariance /= reduced_chi_square;
}

// Covariance of (B, f, eta, omega, h) from that of the fitted parameters.
Eigen::MatrixXd in_law_parameters(const Fit& fit) {
  const FrictionLaw law = law_of(fit.value);
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(kAll, kAll);
  j(0, kB) = 1;
  j(1, kF) = 1;
  j(2, kLogEta) = law.width;
  j(3, kG) = 1 / law.amplitude;
  j(3, kF) = -law.second_weight / law.amplitude;
  j(4, kAsinhH) = std::hypot(1.0, law.second_shape);
  return j * fit.covariance * j.transpose();
}

double chi_square_at(const std::vector<Point>& points, const std::vector<double>& sigma, const Fit& fit,
                     double asinh_h) {
  Eigen::VectorXd p = fit.value;
  p[kAsinhH] = asinh_h;
  return finish(points, sigma, p, true).residuals.squaredNorm();
}

// A sharp kink at rest is the same with (g, h) and (-g, 2 - h), but h > 0 adds a kink at the speed h eta. Where that is
// beyond every speed, h < 0 is meant.
Eigen::VectorXd without_unseen_kink(const std::vector<Point>& points, Eigen::VectorXd p) {
  double fastest = 0;
  for (const Point& point : points) fastest = std::max(fastest, std::abs(point.v));
  if (shape(p) * std::exp(p[kLogEta]) < 2 * fastest || shape(p) < 2) return p;
  p[kAsinhH] = std::asinh(2 - shape(p));
  p[kG] = -p[kG];
  return p;
}

// Only if a perfectly sharp kink is excluded by much: chance makes it look blunt in a few logs of a hundred.
bool shape_is_known(const std::vector<Point>& points, const std::vector<double>& sigma, const Fit& fit) {
  if (!fit.determined) return false;
  const double error = std::sqrt(in_law_parameters(fit)(4, 4)), h = shape(fit.value);
  if (error > kWidestKnown * std::abs(h - 1)) return false;
  const double best = fit.residuals.squaredNorm();
  const double noise = best / static_cast<double>(points.size() - static_cast<std::size_t>(kAll));
  return chi_square_at(points, sigma, fit, std::copysign(std::asinh(kLargestShape), h)) > best + kSharpExcluded * noise;
}

// The least sharp |h| on the fitted side that the points still allow (95 %, profile of chi^2).
double bound_on_shape(const std::vector<Point>& points, const std::vector<double>& sigma, const Fit& fit) {
  const double best = fit.residuals.squaredNorm();
  const double noise = best / std::max(static_cast<double>(points.size()) - 4, 1.0);
  const auto allowed = [&](double asinh_h) {
    return chi_square_at(points, sigma, fit, asinh_h) < best + kChiSquare95 * noise;
  };
  double inside = std::asinh(shape(fit.value)), outside = 0;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (inside + outside);
    (allowed(middle) ? inside : outside) = middle;
  }
  return std::sinh(inside);
}

// When no speed falls into the kink: h stays what robot.yaml says if the points allow that, or becomes the bound.
Fit assume_shape(const std::vector<Point>& points, const std::vector<double>& sigma, const Fit& free, double known,
                 double& h, Estimate& e) {
  Eigen::VectorXd sharp = free.value;
  if (sharp[kAsinhH] > 0) sharp[kG] = -sharp[kG];  // a step at rest alone
  sharp[kAsinhH] = -std::asinh(kLargestShape);
  const Fit sharpest = finish(points, sigma, sharp, true);
  const double bound = bound_on_shape(points, sigma, sharpest);
  h = std::min(known, bound);
  const double eta = std::exp(sharpest.value[kLogEta]);
  e.assumed = {"second_shape"};
  e.warnings.push_back(fmt::format(
      "h is not determined: no speed falls into its kink, narrower than {:.2g} rad/s. The log says h < {:.3g} "
      "(95 %); {:.6g} is {}",
      eta / (1 - bound), bound, h, h == known ? "kept from robot.yaml" : "this bound"));
  sharp = sharpest.value;
  sharp[kAsinhH] = std::asinh(h);
  return finish(points, sigma, sharp, true);
}

std::vector<Point> without_outliers(const std::vector<Point>& points, const Fit& fit) {
  const std::vector<bool> inside = inliers({fit.residuals.data(), points.size()}, 10.0);  // in standard deviations
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (inside[i]) kept.push_back(points[i]);
  }
  return kept;
}

void check_signs(const Log& log, const std::vector<Point>& points, int joint) {
  double power = 0;
  for (const Point& point : points) power += point.tau * point.v;
  if (power <= 0) {
    throw InputError(log.source, joint_column("tau", joint), "friction drives the motor: a column has the wrong sign");
  }
}

// tau of the law over its speeds: evenly spaced on a logarithmic scale, for the kinks are at the slow end.
Series law_curve(const FrictionLaw& law, double slowest, double fastest) {
  constexpr int kPoints = 400;
  Series curve{"fit (24)", kFittedColour, Style::kLine, {}, {}};
  for (int i = 0; i <= kPoints; ++i) {
    const double v = slowest * std::pow(fastest / slowest, static_cast<double>(i) / kPoints);
    curve.x.push_back(v);
    curve.y.push_back(law.torque(v));
  }
  return curve;
}

// Fig. 10 as the paper has it; and over |dtheta| on a logarithmic scale, where the kinks can be seen.
std::vector<Chart> charts_of(int joint, const std::vector<Point>& points, const FrictionLaw& law) {
  const std::string title = fmt::format("Fig. 10: friction of motor {}", joint + 1);
  const std::string speed = "|dtheta| [rad/s]";
  Series measured{"measured", kMeasuredColour, Style::kRings, {}, {}}, forward = measured, backward = measured;
  forward.name = "forward";
  backward.name = "backward, tau reversed";
  backward.colour = "#e377c2";
  std::vector<double> size, residuals;
  for (const Point& point : points) {
    measured.x.push_back(point.v);
    measured.y.push_back(point.tau);
    Series& side = point.v > 0 ? forward : backward;
    size.push_back(std::abs(point.v));
    side.x.push_back(size.back());
    side.y.push_back(std::copysign(1.0, point.v) * point.tau);
    residuals.push_back(point.tau - law.torque(point.v));
  }
  const auto [slowest, fastest] = std::minmax_element(size.begin(), size.end());
  const Series half = law_curve(law, *slowest, *fastest);
  Series whole = half;  // the law is odd
  for (std::size_t i = 0; i < half.x.size(); ++i) {
    whole.x.insert(whole.x.begin(), -half.x[i]);
    whole.y.insert(whole.y.begin(), -half.y[i]);
  }
  Chart residual = residual_chart(title, speed, "residual [N m]", size, residuals);
  residual.logarithmic_x = true;
  return {{title, "dtheta [rad/s]", "tau [N m]", {measured, whole}},
          {title + ", slow speeds", speed, "tau [N m]", {forward, backward, half}, true},
          residual};
}

// In N m, unlike the residuals of the fit.
void add_goodness(const std::vector<Point>& points, const FrictionLaw& law, Estimate& e) {
  double square = 0, total = 0;
  for (const Point& point : points) {
    square += std::pow(law.torque(point.v) - point.tau, 2);
    total += point.tau * point.tau;
  }
  e.points = points.size();
  e.residual_unit = "N m";
  e.residual_rms = std::sqrt(square / static_cast<double>(points.size()));
  e.r_squared = 1 - square / total;
}

}  // namespace

Estimate identify_motor_friction(const Log& log, int joint, const Parameters& robot) {
  const auto j = static_cast<std::size_t>(joint);
  require_experiment(log, "motor_friction", joint);
  Estimate e;
  e.names = {"viscous", "amplitude", "width", "second_weight", "second_shape"};
  e.units = {"N m s/rad", "N m", "rad/s", "1", "1"};
  warn_of_gaps(log, e.warnings);
  std::vector<Point> points = averages(log, joint, robot, e.warnings);
  check_signs(log, points, joint);

  Fit fit = best_of_many_starts(log, points, deviations(points, nullptr));
  const std::size_t before = points.size();
  FrictionLaw law = law_of(fit.value);
  fit = finish(points, deviations(points, &law), fit.value, false);
  points = without_outliers(points, fit);
  warn_of_outliers(before - points.size(), "speeds", e.warnings);
  law = law_of(fit.value);
  const std::vector<double> sigma = deviations(points, &law);
  fit = finish(points, sigma, without_unseen_kink(points, fit.value), false);
  double h = shape(fit.value);
  if (!shape_is_known(points, sigma, fit)) fit = assume_shape(points, sigma, fit, robot.friction.second_shape[j], h, e);

  never_below_the_points(fit);
  law = law_of(fit.value);
  law.second_shape = h;  // unrounded, where it was assumed
  e.value.resize(5);
  e.value << law.viscous, law.amplitude, law.width, law.second_weight, law.second_shape;
  e.covariance = in_law_parameters(fit);
  add_goodness(points, law, e);
  e.charts = charts_of(joint, points, law);
  warn_of_doubt(e);
  require_plausible(log, fmt::format("the viscous friction of motor {} [N m s/rad]", joint + 1), law.viscous,
                    robot.friction.viscous[j]);
  require_plausible(log, fmt::format("the amplitude f of motor {} [N m]", joint + 1), law.amplitude,
                    robot.friction.amplitude[j]);
  return e;
}

}  // namespace fjr
