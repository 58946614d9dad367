#include "model/identify/friction_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/input_error.h"

namespace fjr {
namespace {

constexpr std::size_t kFinished = 4;  // starts
constexpr double kExact = 0.1;        // reduced chi^2 below which the points have no noise of their own

// Returns tau of the law, in a form without division by f.
double torque(const Eigen::VectorXd& p, double v) {
  const double s = v / std::exp(p[kLogEta]), first = std::tanh(s);
  return p[kB] * v + p[kF] * first - p[kG] * std::tanh(s - shape(p) * first);
}

Eigen::VectorXd start_at(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, double eta,
                         double h, double& cost) {
  const auto m = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd a(m, 3);
  Eigen::VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const FrictionPoint& point = points[static_cast<std::size_t>(i)];
    const double s = point.v / eta, first = std::tanh(s), weight = 1 / sigma[static_cast<std::size_t>(i)];
    a.row(i) << weight * point.v, weight * first, -weight * std::tanh(s - h * first);
    b[i] = weight * point.tau;
  }
  const Fit fit = linear_fit(a, b);
  Eigen::VectorXd p(static_cast<Eigen::Index>(kFrictionParameters));
  p << fit.value[0], fit.value[1], std::log(eta), fit.value[2], std::asinh(h);
  const bool physical = fit.determined && fit.value[0] > 0 && fit.value[1] > 0;
  cost = physical ? fit.residuals.squaredNorm() : HUGE_VAL;
  return p;
}

bool physical(const Eigen::VectorXd& p) { return p.allFinite() && p[kB] >= 0 && p[kF] > 0; }

// Speeds of the points. [rad/s]
struct SpeedRange {
  double slowest = HUGE_VAL, fastest = 0;
};

SpeedRange range_of(const std::vector<FrictionPoint>& points) {
  SpeedRange range;
  for (const FrictionPoint& point : points) {
    range.slowest = std::min(range.slowest, std::abs(point.v));
    range.fastest = std::max(range.fastest, std::abs(point.v));
  }
  return range;
}

struct Start {
  double cost;
  Eigen::VectorXd p;
};

// Returns the starts of the whole grid, the best first.
std::vector<Start> all_starts(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma) {
  const auto [slowest, fastest] = range_of(points);
  std::vector<Start> starts;
  for (double eta = std::max(slowest, 1e-3 * fastest); eta <= fastest; eta *= 1.25) {
    for (double size = 0.1; size < kLargestShape; size *= 1.3) {
      for (const double h : {size, -size}) {
        double cost = 0;
        Eigen::VectorXd p = start_at(points, sigma, eta, h, cost);
        if (std::isfinite(cost)) starts.push_back({cost, std::move(p)});
      }
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
  return starts;
}

// Returns whether two starts are neighbours on the grid, which would lead to the same minimum.
bool are_neighbours(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::abs(a[kLogEta] - b[kLogEta]) < 0.3 && a[kAsinhH] * b[kAsinhH] > 0 &&
         std::abs(a[kAsinhH] - b[kAsinhH]) < 0.5;
}

}  // namespace

double shape(const Eigen::VectorXd& p) { return std::clamp(std::sinh(p[kAsinhH]), -kLargestShape, kLargestShape); }

FrictionLaw law_of(const Eigen::VectorXd& p) { return {p[kB], p[kF], std::exp(p[kLogEta]), p[kG] / p[kF], shape(p)}; }

std::vector<double> deviations(const std::vector<FrictionPoint>& points, const FrictionLaw* law) {
  double range = 0;
  for (const FrictionPoint& point : points) range = std::max(range, std::abs(point.tau));
  std::vector<double> sigma;
  for (const FrictionPoint& point : points) {
    const double by_speed = law == nullptr ? 0 : law->slope(point.v) * point.sigma_v;
    sigma.push_back(std::max(std::hypot(point.sigma_tau, by_speed), 1e-6 * range));
  }
  return sigma;
}

Fit finish(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Eigen::VectorXd& p,
           bool fix_h) {
  const auto size = static_cast<Eigen::Index>(points.size());
  const Eigen::Index free = fix_h ? kAsinhH : kFrictionParameters;
  const double h = p[kAsinhH];
  Fit fit = curve_fit(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
        Eigen::VectorXd all(static_cast<Eigen::Index>(kFrictionParameters));
        all.head(free) = x;
        if (fix_h) all[kAsinhH] = h;
        for (Eigen::Index i = 0; i < size; ++i) {
          const FrictionPoint& point = points[static_cast<std::size_t>(i)];
          r[i] = (torque(all, point.v) - point.tau) / sigma[static_cast<std::size_t>(i)];
        }
      },
      size, p.head(free));
  if (fix_h) {
    fit.value.conservativeResize(kFrictionParameters);
    fit.value[kAsinhH] = h;
    fit.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(kFrictionParameters, kFrictionParameters));
  }
  return fit;
}

Fit best_of_many_starts(const Log& log, const std::vector<FrictionPoint>& points, const std::vector<double>& sigma) {
  Fit best;
  double cost = HUGE_VAL;
  std::size_t finished = 0;
  const Eigen::VectorXd* last = nullptr;
  const std::vector<Start> starts = all_starts(points, sigma);
  for (const Start& start : starts) {
    if (last != nullptr && are_neighbours(start.p, *last)) continue;
    if (finished++ == kFinished) break;
    last = &start.p;
    Fit fit = finish(points, sigma, start.p, false);
    if (!physical(fit.value) || !(fit.residuals.squaredNorm() < cost)) continue;
    cost = fit.residuals.squaredNorm();
    best = std::move(fit);
  }
  if (std::isfinite(cost)) return best;
  const auto [slowest, fastest] = range_of(points);
  throw InputError(log.source, "",
                   fmt::format("no friction law with positive f and B fits these torques at {:.3g} to {:.3g} rad/s",
                               slowest, fastest));
}

void never_below_the_points(Fit& fit) {
  const double degrees = static_cast<double>(std::max<Eigen::Index>(fit.residuals.size() - kFrictionParameters, 1));
  const double reduced_chi_square = fit.residuals.squaredNorm() / degrees;
  if (reduced_chi_square < 1 && reduced_chi_square > kExact) fit.covariance /= reduced_chi_square;
}

Eigen::MatrixXd in_law_parameters(const Fit& fit) {
  const FrictionLaw law = law_of(fit.value);
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(kFrictionParameters, kFrictionParameters);
  j(0, kB) = 1;
  j(1, kF) = 1;
  j(2, kLogEta) = law.width;
  j(3, kG) = 1 / law.amplitude;
  j(3, kF) = -law.second_weight / law.amplitude;
  j(4, kAsinhH) = std::hypot(1.0, law.second_shape);
  return j * fit.covariance * j.transpose();
}

}  // namespace fjr
