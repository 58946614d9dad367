#include "planner/nlp/kkt_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fjr {
namespace {

constexpr double kPivotThreshold = 1e-8;  // Ipopt's for MA27
constexpr double kFirstShift = 1e-4, kLeastShift = 1e-20, kMostShift = 1e20;
constexpr double kFirstGrowth = 100, kGrowth = 8, kDecay = 3;
// A smaller shift of the Hessian is not carried over to the next iteration, because Newton's method converges
// quadratically only without a shift.
constexpr double kCarried = 1e-5;
constexpr int kRefinements = 10;
constexpr double kResidual = 1e-10;  // relative residual below which a solution is not refined further

}  // namespace

KktSystem::KktSystem(const SlackForm& form, DoBoth both) : both_(std::move(both)) {
  factor_.analyse(form.kkt().rows, form.kkt().cols, form.kkt_structure());
}

KktSystem::Inertia KktSystem::try_with(SlackForm& form, const Vector& d, double shift, double regularised) {
  form.set_diagonal(d + shift * form.shift_weights, regularised);
  ++factorisations_;
  const ChainLdlt::Outcome outcome =
      factor_.factorise(form.kkt().values, kPivotThreshold, static_cast<int>(form.constraints()), both_);
  multiplications_ += factor_.factorisation_work();
  if (outcome == ChainLdlt::Outcome::kSingular) return Inertia::kSingular;
  if (outcome != ChainLdlt::Outcome::kDone) return Inertia::kWrong;
  // With a Jacobian of full rank there are at least as many negative eigenvalues as constraints, whatever the Hessian.
  if (factor_.negative_eigenvalues() < form.constraints()) return Inertia::kSingular;
  return factor_.negative_eigenvalues() == form.constraints() ? Inertia::kRight : Inertia::kWrong;
}

// Inertia correction. If the last iteration needed a large shift of the Hessian, this one probably needs one as well.
// Therefore it starts with a fraction of that shift, whereas Ipopt always tries without a shift first.
bool KktSystem::factorise(SlackForm& form, const Vector& d, double mu) {
  double shift = shift_ > kCarried ? shift_ / kDecay : 0, regularised = 0;
  while (shift <= kMostShift) {
    const Inertia inertia = try_with(form, d, shift, regularised);
    if (inertia == Inertia::kRight) {
      shift_ = shift;
      if (shift > 0) last_shift_ = shift;
      return true;
    }
    if (inertia == Inertia::kSingular && regularised == 0) {
      regularised = 1e-8 * std::pow(mu, 0.25);
      if (shift == 0 && regularised > 0) continue;
    }
    if (shift == 0) {
      shift = last_shift_ == 0 ? kFirstShift : std::max(kLeastShift, last_shift_ / kDecay);
    } else {
      shift *= last_shift_ == 0 ? kFirstGrowth : kGrowth;
    }
  }
  return false;
}

bool KktSystem::factorise_projection(SlackForm& form) {
  form.clear_hessian();
  return try_with(form, Vector::Ones(form.variables()), 0, 0) == Inertia::kRight;
}

KktSystem::Vector KktSystem::solve(const SlackForm& form, const Vector& right) const {
  const auto apply = [this](Vector& b) {
    factor_.solve({b.data(), static_cast<std::size_t>(b.size())}, both_);
    multiplications_ += factor_.solve_work();
  };
  const auto size = [](const Vector& b) { return b.lpNorm<Eigen::Infinity>(); };
  Vector x = right, residual;
  apply(x);
  for (int i = 0; i < kRefinements; ++i) {
    form.multiply(x, residual);
    residual = right - residual;
    if (!(size(residual) > kResidual * (std::min(size(x), 1e6 * size(right)) + size(right)))) break;
    apply(residual);
    x += residual;
  }
  return x;
}

}  // namespace fjr
