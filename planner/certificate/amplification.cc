#include "planner/certificate/amplification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace fjr {
namespace {

constexpr double kLongestRest = 0.1;     // [s]
constexpr double kLargestGrowth = 3;     // [-] exponent
constexpr double kGrowthSpacing = 0.01;  // [s] the growth rate follows q, which takes 0.1 s and more to change

// Returns the uninterrupted stays of the joint's motor within +-band [rad/s] for more than kLongestRest.
std::vector<Stretch> long_rests(const Trajectory& trajectory, int joint, double band) {
  Interpolator plan(trajectory);
  const auto rests = [&](double time) {
    return std::abs(plan.at(time).state.dtheta[static_cast<std::size_t>(joint - 1)]) <= band;
  };
  std::vector<Stretch> found;
  std::optional<double> since;
  const auto leave = [&](double time) {
    if (since && time - *since > kLongestRest) {
      found.push_back({*since, time, joint,
                       fmt::format("motor {} rests from {:.3f} s to {:.3f} s within {:.2e} rad/s, where its friction "
                                   "falls with speed: errors grow exponentially",
                                   joint, *since, time, band)});
    }
    since.reset();
  };
  for (std::size_t k = 0; k + 1 < trajectory.samples.size(); ++k) {
    const double from = trajectory.samples[k].time, to = trajectory.samples[k + 1].time;
    if (!(rests(from) && rests(0.5 * (from + to)) && rests(to))) {
      leave(from);
    } else if (!since) {
      since = from;
    }
  }
  leave(trajectory.end_time());
  return found;
}

struct Symmetric {  // 2x2
  double a11, a12, a22;
  double smallest_eigenvalue() const { return 0.5 * (a11 + a22) - std::hypot(0.5 * (a11 - a22), a12); }
};

// Returns M s^2 + D s + dG/dq + K (J s^2 + B s) (J s^2 + B s + K)^-1. Its last term is the spring in series with the
// motor, which gives way.
Symmetric dynamic_stiffness(const Parameters& p, const Joints<double>& q, double s) {
  const MassMatrix<double> m = mass_matrix(p, q[1]);
  const Joints<double> gravity = gravity_coefficients(p);
  const double hanging = q[0] - p.mounting.down;
  const double g1 = gravity[0] * std::cos(hanging), g2 = gravity[1] * std::cos(hanging + q[1]);
  const auto diagonal = [&](std::size_t j) {
    const double motor = (p.motor.inertia[j] * s + p.friction.viscous[j]) * s, k = p.spring.stiffness[j];
    return p.link.damping[j] * s + k * motor / (motor + k);
  };
  return {m.m11 * s * s + g1 + g2 + diagonal(0), m.m12 * s * s + g2, m.m22 * s * s + g2 + diagonal(1)};
}

std::vector<Stretch> growth_by_gravity(const Parameters& p, const Trajectory& trajectory) {
  Interpolator plan(trajectory);
  std::vector<Stretch> found;
  double exponent = 0, since = trajectory.start_time();
  const double duration = trajectory.end_time() - trajectory.start_time();
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration / kGrowthSpacing)));
  const double piece = duration / pieces;
  for (int k = 0; k + 1 < pieces; ++k) {  // at the end nothing is left to begin again
    const double middle = trajectory.start_time() + (k + 0.5) * piece, end = middle + 0.5 * piece;
    exponent += gravity_growth_rate(p, plan.at(middle).state.q) * piece;
    if (exponent <= kLargestGrowth) continue;
    found.push_back({end, end, 0,
                     fmt::format("the arm stays near the upright: between {:.3f} s and {:.3f} s gravity amplifies "
                                 "errors {:.0f}-fold",
                                 since, end, std::exp(exponent))});
    exponent = 0;
    since = end;
  }
  return found;
}

}  // namespace

double gravity_growth_rate(const Parameters& p, const Joints<double>& q) {
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

std::vector<Stretch> stretches_of_amplification(const Parameters& p, const Trajectory& trajectory) {
  std::vector<Stretch> found = growth_by_gravity(p, trajectory);
  for (int joint = 1; joint <= kJoints; ++joint) {
    const double band = FrictionLaw::of(p, joint - 1).unstable_band();
    if (band == 0) continue;
    const std::vector<Stretch> rests = long_rests(trajectory, joint, band);
    found.insert(found.end(), rests.begin(), rests.end());
  }
  std::stable_sort(found.begin(), found.end(), [](const Stretch& a, const Stretch& b) { return a.to < b.to; });
  return found;
}

}  // namespace fjr
