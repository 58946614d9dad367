#include "planner/nlp/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fjr {
namespace {

using Vector = Eigen::VectorXd;
using Eigen::Index;

constexpr double kWeight = 1e-6;        // rho: what replans of neighbours take with 1e-7 to 1e-5 is in bench/README.md
constexpr double kFromBounds = 1e-2;    // relative distance from the bounds at which it begins
constexpr double kFirstProduct = 1e-3;  // least product of multiplier and distance at which it begins
constexpr double kNearBoundary = 0.99;  // fraction of the way to the bounds that a step may go
constexpr int kMostIterations = 30;     // most of those that were solved took 7 to 15
// So many steps in a row that are shorter than this mean that the linearised constraints contradict the bounds.
constexpr int kMostShortSteps = 3;
constexpr double kShortStep = 0.1;
constexpr double kMostCorrection = 10;  // times the mean product: larger corrections lead away from the solution
constexpr double kRowTolerance = 1e-9, kDualTolerance = 1e-7;
constexpr double kProductTolerance = 20;  // times mu

double largest(const Vector& v) { return v.size() == 0 ? 0 : v.lpNorm<Eigen::Infinity>(); }

// Products of the distances from the bounds with their multipliers.
struct Products {
  double mean, largest;
};

class QuadraticProgram {
 public:
  QuadraticProgram(SlackForm& form, KktSystem& system, const PrimalDual& at, const Vector& gradient, const Vector& c,
                   double mu)
      : form_(form), system_(system), from_(at.v), gradient_(gradient), c_(c), mu_(mu), now_(at) {
    form_.push_off_bounds(now_.v, kFromBounds);
    form_.keep_multipliers_above(kFirstProduct * form_.inverse_distance_to_lower(now_.v),
                                 kFirstProduct * form_.inverse_distance_to_upper(now_.v), now_);
  }

  std::optional<PrimalDual> solve(const std::function<bool()>& may_go_on) {
    for (int k = 0;; ++k) {
      find_residuals();
      if (solved()) return std::move(now_);
      if (k == kMostIterations || !may_go_on() || !advance()) return std::nullopt;
    }
  }

 private:
  Products products(const Vector& v, const Vector& z_lower, const Vector& z_upper) const {
    double sum = 0, largest = 0;
    const auto add = [&](double product) {
      sum += product;
      largest = std::max(largest, product);
    };
    for (const Index i : form_.lower_bounded) add((v(i) - form_.lower(i)) * z_lower(i));
    for (const Index i : form_.upper_bounded) add((form_.upper(i) - v(i)) * z_upper(i));
    const std::size_t bounds = form_.lower_bounded.size() + form_.upper_bounded.size();
    return {sum / std::max(1.0, static_cast<double>(bounds)), largest};
  }

  void find_residuals() {
    form_.set_diagonal(Vector::Constant(now_.v.size(), kWeight), 0);
    Vector point(now_.v.size() + now_.y.size()), product;
    point << now_.v - from_, now_.y;
    form_.multiply(point, product);
    dual_ = gradient_ + product.head(now_.v.size()) - now_.z_lower + now_.z_upper;
    rows_ = c_ + product.tail(now_.y.size());
    products_ = products(now_.v, now_.z_lower, now_.z_upper);
    inverse_to_lower_ = form_.inverse_distance_to_lower(now_.v);
    inverse_to_upper_ = form_.inverse_distance_to_upper(now_.v);
  }

  bool solved() const {
    return largest(rows_) <= kRowTolerance && largest(dual_) <= std::max(kDualTolerance, mu_) &&
           products_.largest <= kProductTolerance * mu_;
  }

  // Returns the Newton step towards these products of the bounds.
  PrimalDual step_to(const Vector& at_lower, const Vector& at_upper) const {
    Vector right(now_.v.size() + now_.y.size());
    right << at_lower.cwiseProduct(inverse_to_lower_) - at_upper.cwiseProduct(inverse_to_upper_) - now_.z_lower +
                 now_.z_upper - dual_,
        -rows_;
    const Vector solution = system_.solve(form_, right);
    PrimalDual step{solution.head(now_.v.size()), solution.tail(now_.y.size()), {}, {}};
    step.z_lower = inverse_to_lower_.cwiseProduct(at_lower - now_.z_lower.cwiseProduct(step.v)) - now_.z_lower;
    step.z_upper = inverse_to_upper_.cwiseProduct(at_upper + now_.z_upper.cwiseProduct(step.v)) - now_.z_upper;
    return step;
  }

  // The fractions of a step that the point, and the multipliers, may go.
  struct Lengths {
    double point, multipliers;
  };
  Lengths longest(const PrimalDual& step, double fraction) const {
    return {form_.longest_step(now_.v, step.v, fraction), form_.longest_multiplier_step(now_, step, fraction)};
  }

  // Makes one step. Returns false if there is none, or if the last ones were short.
  bool advance() {
    const Vector barrier = now_.z_lower.cwiseProduct(inverse_to_lower_) + now_.z_upper.cwiseProduct(inverse_to_upper_);
    const Vector diagonal = barrier + Vector::Constant(now_.v.size(), kWeight);
    if (!diagonal.allFinite() || !system_.factorise(form_, diagonal, std::max(products_.mean, mu_))) return false;
    const PrimalDual step = corrected(predictor());
    const Lengths alpha = longest(step, std::max(kNearBoundary, 1 - products_.mean));
    now_.v += alpha.point * step.v;
    now_.y += alpha.multipliers * step.y;
    now_.z_lower += alpha.multipliers * step.z_lower;
    now_.z_upper += alpha.multipliers * step.z_upper;
    short_steps_ = std::max(alpha.point, alpha.multipliers) < kShortStep ? short_steps_ + 1 : 0;
    return short_steps_ < kMostShortSteps;
  }

  PrimalDual predictor() const { return step_to(Vector::Zero(now_.v.size()), Vector::Zero(now_.v.size())); }

  // Returns the step towards products that the predictor's lengths make likely, which also allows for what the
  // predictor neglects: products of two changes.
  PrimalDual corrected(const PrimalDual& predicted) const {
    const Lengths alpha = longest(predicted, 1);
    const double mean = std::max(products_.mean, mu_),
                 reached =
                     products(now_.v + alpha.point * predicted.v, now_.z_lower + alpha.multipliers * predicted.z_lower,
                              now_.z_upper + alpha.multipliers * predicted.z_upper)
                         .mean;
    const double target = std::max(mu_, mean * std::pow(reached / mean, 3)), most = kMostCorrection * mean;
    const auto towards = [&](const Vector& second_order) -> Vector {
      return (Vector::Constant(second_order.size(), target) - second_order).cwiseMax(-most).cwiseMin(most);
    };
    return step_to(towards(predicted.v.cwiseProduct(predicted.z_lower)),
                   towards(-predicted.v.cwiseProduct(predicted.z_upper)));
  }

  SlackForm& form_;
  KktSystem& system_;
  const Vector &from_, &gradient_, &c_;
  const double mu_;  // which all products are to come to
  PrimalDual now_;
  Vector dual_, rows_;                          // residuals
  Vector inverse_to_lower_, inverse_to_upper_;  // inverse distances from the bounds
  Products products_{};
  int short_steps_ = 0;
};

}  // namespace

std::optional<PrimalDual> solve_quadratic_program(SlackForm& form, KktSystem& system, const PrimalDual& at,
                                                  const Vector& gradient, const Vector& c, double mu,
                                                  const std::function<bool()>& may_go_on) {
  return QuadraticProgram(form, system, at, gradient, c, mu).solve(may_go_on);
}

}  // namespace fjr
