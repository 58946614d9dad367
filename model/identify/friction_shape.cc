#include "model/identify/friction_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

constexpr double kResolved = 0.2;       // fraction of the kink's width to which speeds must be known to resolve it
constexpr double kChiSquare95 = 3.841;  // one degree of freedom
constexpr double kWidestKnown = 0.3;    // relative standard error of h - 1 up to which linear theory is believed
constexpr double kSharpExcluded = 25;   // by five standard deviations

double chi_square_at(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& fit,
                     double asinh_h) {
  Eigen::VectorXd p = fit.value;
  p[kAsinhH] = asinh_h;
  return finish(points, sigma, p, true).residuals.squaredNorm();
}

// Returns the smallest |h| on the fitted side that the points still allow (95 %, profile of chi^2).
double bound_on_shape(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& fit) {
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

// Returns whether the speeds within the kink at rest are known accurately enough to determine its width. Blunt kinks
// are at higher speeds, where they always are.
bool speeds_resolve_kink(const std::vector<FrictionPoint>& points, const FrictionLaw& law) {
  const double width = law.width / std::abs(1 - law.second_shape);
  double error = HUGE_VAL;
  for (const FrictionPoint& point : points) error = std::min(error, point.sigma_v);
  return law.second_shape > 1 || error < kResolved * width;
}

}  // namespace

Eigen::VectorXd without_unseen_kink(const std::vector<FrictionPoint>& points, Eigen::VectorXd p) {
  double fastest = 0;
  for (const FrictionPoint& point : points) fastest = std::max(fastest, std::abs(point.v));
  if (shape(p) * std::exp(p[kLogEta]) < 2 * fastest || shape(p) < 2) return p;
  p[kAsinhH] = std::asinh(2 - shape(p));
  p[kG] = -p[kG];
  return p;
}

bool shape_is_known(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& fit) {
  if (!fit.determined || !speeds_resolve_kink(points, law_of(fit.value))) return false;
  const double error = std::sqrt(in_law_parameters(fit)(4, 4)), h = shape(fit.value);
  if (error > kWidestKnown * std::abs(h - 1)) return false;
  const double best = fit.residuals.squaredNorm();
  const double noise = best / static_cast<double>(points.size() - static_cast<std::size_t>(kFrictionParameters));
  return chi_square_at(points, sigma, fit, std::copysign(std::asinh(kLargestShape), h)) > best + kSharpExcluded * noise;
}

Fit assume_shape(const std::vector<FrictionPoint>& points, const std::vector<double>& sigma, const Fit& free,
                 double known, double& h, Estimate& e) {
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

}  // namespace fjr
