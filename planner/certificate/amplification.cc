#include "planner/certificate/amplification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fjr {
namespace {

constexpr double kLongestRest = 0.1;     // [s]
constexpr double kLargestGrowth = 3;     // [-] exponent
constexpr double kGrowthSpacing = 0.01;  // [s] the growth rate follows q, which takes 0.1 s and more to change

struct Stay {
  double from = 0, to = 0;  // [s]
  double length() const { return to - from; }
};

// Longest uninterrupted stay of joint j's motor within +-band.
Stay longest_rest(const Trajectory& trajectory, std::size_t j, double band) {
  Interpolator plan(trajectory);
  Stay longest, now{trajectory.start_time(), trajectory.start_time()};
  const auto rests = [&](double time) { return std::abs(plan.at(time).state.dtheta[j]) <= band; };
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const double from = trajectory.samples[k].time, to = trajectory.samples[k + 1].time;
    if (rests(from) && rests(0.5 * (from + to)) && rests(to)) {
      now.to = to;
    } else {
      now = {to, to};
    }
    if (now.length() > longest.length()) longest = now;
  }
  return longest;
}

struct Symmetric {  // 2x2
  double a11, a12, a22;
  double smallest_eigenvalue() const { return 0.5 * (a11 + a22) - std::hypot(0.5 * (a11 - a22), a12); }
};

// M s^2 + D s + dG/dq + K (J s^2 + B s) (J s^2 + B s + K)^-1: the spring in series with the motor that gives way.
Symmetric dynamic_stiffness(const Parameters& p, const Pair<double>& q, double s) {
  const MassMatrix<double> m = mass_matrix(p, q[1]);
  const Pair<double> gravity = gravity_coefficients(p);
  const double g1 = gravity[0] * std::cos(q[0]), g2 = gravity[1] * std::cos(q[0] + q[1]);
  const auto diagonal = [&](std::size_t j) {
    const double motor = (p.motor.inertia[j] * s + p.friction.viscous[j]) * s, k = p.spring.stiffness[j];
    return p.link.damping[j] * s + k * motor / (motor + k);
  };
  return {m.m11 * s * s + g1 + g2 + diagonal(0), m.m12 * s * s + g2, m.m22 * s * s + g2 + diagonal(1)};
}

struct Growth {
  double exponent = 0;
  Stay where;
};

Growth gravity_growth(const Parameters& p, const Trajectory& trajectory) {
  Interpolator plan(trajectory);
  Growth growth;
  const double duration = trajectory.end_time() - trajectory.start_time();
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration / kGrowthSpacing)));
  const double piece = duration / pieces;
  for (int k = 0; k < pieces; ++k) {
    const double middle = trajectory.start_time() + (k + 0.5) * piece;
    const double rate = gravity_growth_rate(p, plan.at(middle).state.q);
    if (rate <= 0) continue;
    if (growth.exponent == 0) growth.where.from = middle - 0.5 * piece;
    growth.where.to = middle + 0.5 * piece;
    growth.exponent += rate * piece;
  }
  return growth;
}

}  // namespace

double gravity_growth_rate(const Parameters& p, const Pair<double>& q) {
  if (dynamic_stiffness(p, q, 0).smallest_eigenvalue() >= 0) return 0;
  // Every term increases with s, so the smallest eigenvalue does: its zero is the largest root, and bisection finds it.
  double low = 0, high = 1;
  while (dynamic_stiffness(p, q, high).smallest_eigenvalue() < 0) high *= 2;
  while (high - low > 1e-6 * high) {
    const double middle = 0.5 * (low + high);
    (dynamic_stiffness(p, q, middle).smallest_eigenvalue() < 0 ? low : high) = middle;
  }
  return high;
}

std::string why_open_loop_cannot_be_exact(const Parameters& p, const Trajectory& trajectory) {
  for (int joint = 0; joint < kJoints; ++joint) {
    const double band = FrictionLaw::of(p, joint).unstable_band();
    if (band == 0) continue;
    const Stay rest = longest_rest(trajectory, static_cast<std::size_t>(joint), band);
    if (rest.length() <= kLongestRest) continue;
    return fmt::format(
        "motor {} rests from {:.3f} s to {:.3f} s within {:.2e} rad/s, where its friction falls with speed: "
        "errors grow exponentially",
        joint + 1, rest.from, rest.to, band);
  }
  const Growth growth = gravity_growth(p, trajectory);
  if (growth.exponent <= kLargestGrowth) return "";
  return fmt::format(
      "the arm stays near the upright between {:.3f} s and {:.3f} s: gravity amplifies errors {:.0f}-fold",
      growth.where.from, growth.where.to, std::exp(growth.exponent));
}

}  // namespace fjr
