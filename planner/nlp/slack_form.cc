#include "planner/nlp/slack_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fjr {
namespace {

using Eigen::Index;

constexpr double kLargestGradient = 100;
constexpr double kLeastScale = 1e-8;
constexpr double kUnbounded = 1e19;  // beyond this a bound counts as infinite, as in Ipopt

double scale_for(double gradient) {
  return gradient > kLargestGradient ? std::max(kLargestGradient / gradient, kLeastScale) : 1;
}

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

SlackForm::SlackForm(const Nlp& nlp, const Vector& x) : nlp_(nlp) {
  number_variables();
  set_scales(x);
  set_bounds();
  set_pattern();
}

void SlackForm::number_variables() {
  place_.assign(at(nlp_.variables()), -1);
  for (Index i = 0; i < nlp_.variables(); ++i) {
    if (nlp_.x_lower(i) == nlp_.x_upper(i)) continue;
    place_[at(i)] = static_cast<int>(free_.size());
    free_.push_back(i);
  }
  auto next = static_cast<Index>(free_.size());
  for (Index i = 0; i < nlp_.constraints(); ++i) slack_.push_back(nlp_.g_lower(i) == nlp_.g_upper(i) ? -1 : next++);
  lower = upper = Vector::Zero(next);
  x_ = nlp_.x_lower;
  gradient_.resize(nlp_.variables());
  hessian_values_.resize(static_cast<Index>(nlp_.hessian_pattern.size()));
  jacobian_values_.resize(static_cast<Index>(nlp_.jacobian_pattern.size()));
}

void SlackForm::set_scales(const Vector& x) {
  for (const Index i : free_) x_(i) = x(i);
  nlp_.gradient(x_, gradient_);
  double largest = 0;
  for (const Index i : free_) largest = std::max(largest, std::abs(gradient_(i)));
  objective_scale_ = scale_for(largest);
  nlp_.jacobian(x_, jacobian_values_);
  row_scale_ = Vector::Zero(nlp_.constraints());
  for (std::size_t e = 0; e < nlp_.jacobian_pattern.size(); ++e) {
    const Nlp::Entry& entry = nlp_.jacobian_pattern[e];
    if (place_[at(entry.col)] < 0) continue;
    row_scale_(entry.row) = std::max(row_scale_(entry.row), std::abs(jacobian_values_(static_cast<Index>(e))));
  }
  row_scale_ = row_scale_.unaryExpr(&scale_for);
}

void SlackForm::set_bounds() {
  for (std::size_t i = 0; i < free_.size(); ++i) {
    lower(static_cast<Index>(i)) = nlp_.x_lower(free_[i]);
    upper(static_cast<Index>(i)) = nlp_.x_upper(free_[i]);
  }
  const bool weighted = nlp_.shift_weights.size() > 0;
  shift_weights = Vector::Constant(variables(), weighted ? 0 : 1);
  for (std::size_t i = 0; weighted && i < free_.size(); ++i) {
    shift_weights(static_cast<Index>(i)) = nlp_.shift_weights(free_[i]);
  }
  for (Index i = 0; i < nlp_.constraints(); ++i) {
    if (!inequality(i)) continue;
    lower(slack_of(i)) = row_scale_(i) * nlp_.g_lower(i);
    upper(slack_of(i)) = row_scale_(i) * nlp_.g_upper(i);
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < variables(); ++i) {
    if (lower(i) <= -kUnbounded) lower(i) = -kInfinity;
    if (upper(i) >= kUnbounded) upper(i) = kInfinity;
    if (std::isfinite(lower(i))) lower_bounded.push_back(i);
    if (std::isfinite(upper(i))) upper_bounded.push_back(i);
  }
}

void SlackForm::set_pattern() {
  const auto add = [this](int row, int col) {
    kkt_.rows.push_back(row);
    kkt_.cols.push_back(col);
  };
  const auto first_row = static_cast<int>(variables());
  for (std::size_t e = 0; e < nlp_.hessian_pattern.size(); ++e) {
    const int i = place_[at(nlp_.hessian_pattern[e].row)], j = place_[at(nlp_.hessian_pattern[e].col)];
    if (i < 0 || j < 0) continue;
    hessian_entry_.push_back(static_cast<Index>(e));
    add(i, j);
  }
  for (std::size_t e = 0; e < nlp_.jacobian_pattern.size(); ++e) {
    const int j = place_[at(nlp_.jacobian_pattern[e].col)];
    if (j < 0) continue;
    jacobian_entry_.push_back(static_cast<Index>(e));
    add(first_row + nlp_.jacobian_pattern[e].row, j);
  }
  for (Index i = 0; i < constraints(); ++i) {
    if (inequality(i)) add(first_row + static_cast<int>(i), static_cast<int>(slack_of(i)));
  }
  kkt_.values.assign(kkt_.rows.size(), -1.0);  // for the slacks; all other values are set before they are used
  for (int i = 0; i < first_row + static_cast<int>(constraints()); ++i) add(i, i);
  kkt_.values.resize(kkt_.rows.size(), 0);
}

// Treats a problem of unknown structure as a chain of a single block.
ChainStructure SlackForm::kkt_structure() const {
  const bool known = nlp_.blocks > 0;
  ChainStructure structure{known ? nlp_.blocks : 1, {}, {}};
  const auto add = [&](const std::vector<int>& blocks, Index i) {
    structure.block.push_back(known ? blocks[at(i)] : 0);
  };
  for (const Index i : free_) add(nlp_.variable_block, i);
  for (Index i = 0; i < constraints(); ++i) {
    if (inequality(i)) add(nlp_.constraint_block, i);
  }
  structure.equality.assign(structure.block.size(), false);
  for (Index i = 0; i < constraints(); ++i) {
    add(nlp_.constraint_block, i);
    structure.equality.push_back(!inequality(i));
  }
  return structure;
}

const SlackForm::Vector& SlackForm::x_at(const Vector& v) const {
  for (std::size_t i = 0; i < free_.size(); ++i) x_(free_[i]) = v(static_cast<Index>(i));
  return x_;
}

SlackForm::Vector SlackForm::from_x(const Vector& x) const {
  Vector v = Vector::Zero(variables()), c;
  for (std::size_t i = 0; i < free_.size(); ++i) v(static_cast<Index>(i)) = x(free_[i]);
  constraint_values(v, c);
  for (Index i = 0; i < constraints(); ++i) {
    if (inequality(i)) v(slack_of(i)) = c(i);
  }
  return v;
}

SlackForm::Vector SlackForm::to_x(const Vector& v) const { return x_at(v); }

// Returns the part of free variables, in the scale of the objective; zero for slacks.
SlackForm::Vector SlackForm::scaled_part_of_free(const Vector& of_variables) const {
  Vector scaled = Vector::Zero(variables());
  for (std::size_t i = 0; i < free_.size(); ++i) {
    scaled(static_cast<Index>(i)) = objective_scale_ * of_variables(free_[i]);
  }
  return scaled;
}

SlackForm::Vector SlackForm::from_bound_multipliers(const Vector& z) const { return scaled_part_of_free(z); }

SlackForm::Vector SlackForm::to_bound_multipliers(const Vector& z) const {
  Vector own = Vector::Zero(nlp_.variables());
  for (std::size_t i = 0; i < free_.size(); ++i) own(free_[i]) = z(static_cast<Index>(i)) / objective_scale_;
  return own;
}

void SlackForm::set_slack_multipliers(const Vector& y, Vector& z_lower, Vector& z_upper) const {
  for (Index i = 0; i < constraints(); ++i) {
    if (!inequality(i)) continue;
    z_lower(slack_of(i)) = std::max(0.0, -y(i));
    z_upper(slack_of(i)) = std::max(0.0, y(i));
  }
}

void SlackForm::keep_multipliers_above(const Vector& least_lower, const Vector& least_upper, PrimalDual& at) const {
  const auto keep = [](const std::vector<Index>& bounded, const Vector& least, Vector& z) {
    Vector kept = Vector::Zero(z.size());
    for (const Index i : bounded) kept(i) = std::max(z(i), least(i));
    z = std::move(kept);
  };
  keep(lower_bounded, least_lower, at.z_lower);
  keep(upper_bounded, least_upper, at.z_upper);
}

void SlackForm::push_off_bounds(Vector& v, double push) const {
  for (Index i = 0; i < variables(); ++i) {
    const double l = lower(i), u = upper(i), most = push * (u - l);
    if (std::isfinite(l)) v(i) = std::max(v(i), l + std::min(push * std::max(1.0, std::abs(l)), most));
    if (std::isfinite(u)) v(i) = std::min(v(i), u - std::min(push * std::max(1.0, std::abs(u)), most));
  }
}

double SlackForm::longest_step(const Vector& v, const Vector& dv, double fraction) const {
  double alpha = 1;
  for (const Index i : lower_bounded) {
    if (dv(i) < 0) alpha = std::min(alpha, -fraction * (v(i) - lower(i)) / dv(i));
  }
  for (const Index i : upper_bounded) {
    if (dv(i) > 0) alpha = std::min(alpha, fraction * (upper(i) - v(i)) / dv(i));
  }
  return alpha;
}

double SlackForm::longest_multiplier_step(const PrimalDual& at, const PrimalDual& step, double fraction) const {
  double alpha = 1;
  for (const Index i : lower_bounded) {
    if (step.z_lower(i) < 0) alpha = std::min(alpha, -fraction * at.z_lower(i) / step.z_lower(i));
  }
  for (const Index i : upper_bounded) {
    if (step.z_upper(i) < 0) alpha = std::min(alpha, -fraction * at.z_upper(i) / step.z_upper(i));
  }
  return alpha;
}

SlackForm::Violation SlackForm::violation(const Vector& v, const Vector& c) const {
  Violation worst;
  for (Index i = 0; i < constraints(); ++i) {
    double here = std::abs(c(i));
    if (inequality(i)) {
      const double value = c(i) + v(slack_of(i));
      here = std::max({0.0, lower(slack_of(i)) - value, value - upper(slack_of(i))});
    }
    worst.scaled = std::max(worst.scaled, here);
    worst.own = std::max(worst.own, here / row_scale_(i));
  }
  return worst;
}

double SlackForm::objective(const Vector& v) const { return objective_scale_ * nlp_.objective(x_at(v)); }

void SlackForm::constraint_values(const Vector& v, Vector& c) const {
  c.resize(constraints());
  nlp_.constraint_values(x_at(v), c);
  for (Index i = 0; i < constraints(); ++i) {
    c(i) = inequality(i) ? row_scale_(i) * c(i) - v(slack_of(i)) : row_scale_(i) * (c(i) - nlp_.g_lower(i));
  }
}

void SlackForm::differentiate(const Vector& v, Vector& gradient) {
  nlp_.gradient(x_at(v), gradient_);
  gradient = scaled_part_of_free(gradient_);
  nlp_.jacobian(x_, jacobian_values_);
  double* to = kkt_.values.data() + jacobian_begin();
  for (std::size_t e = 0; e < jacobian_entry_.size(); ++e) {
    const Index from = jacobian_entry_[e];
    to[e] = row_scale_(nlp_.jacobian_pattern[at(from)].row) * jacobian_values_(from);
  }
}

void SlackForm::add_transposed_jacobian(const Vector& y, Vector& to) const {
  const auto first_row = static_cast<int>(variables());
  const std::size_t end = diagonal_begin();
  for (std::size_t e = jacobian_begin(); e < end; ++e) {
    to(kkt_.cols[e]) += kkt_.values[e] * y(kkt_.rows[e] - first_row);
  }
}

void SlackForm::set_hessian(const Vector& v, const Vector& y) {
  const Vector multipliers = y.cwiseProduct(row_scale_);
  nlp_.hessian(x_at(v), objective_scale_, multipliers, hessian_values_);
  for (std::size_t e = 0; e < hessian_entry_.size(); ++e) kkt_.values[e] = hessian_values_(hessian_entry_[e]);
}

void SlackForm::clear_hessian() { std::fill_n(kkt_.values.begin(), hessian_entry_.size(), 0.0); }

void SlackForm::set_diagonal(const Vector& d, double e) {
  double* diagonal = kkt_.values.data() + diagonal_begin();
  std::copy_n(d.data(), d.size(), diagonal);
  std::fill_n(diagonal + d.size(), constraints(), e == 0 ? 0.0 : -e);  // and no -0
}

void SlackForm::multiply(const Vector& by, Vector& product) const {
  product.setZero(by.size());
  const std::size_t diagonal = diagonal_begin();
  for (std::size_t e = 0; e < diagonal; ++e) {
    const int i = kkt_.rows[e], j = kkt_.cols[e];
    product(i) += kkt_.values[e] * by(j);
    if (i != j) product(j) += kkt_.values[e] * by(i);
  }
  for (std::size_t e = diagonal; e < kkt_.values.size(); ++e)
    product(kkt_.rows[e]) += kkt_.values[e] * by(kkt_.rows[e]);
}

}  // namespace fjr
