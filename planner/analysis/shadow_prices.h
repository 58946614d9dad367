// Computes the shadow prices of the arm's limits and of the task constraints from the multipliers of the bounds that
// represent them.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "planner/analysis/analysis.h"
#include "planner/analysis/optimality.h"
#include "planner/collocation/transcription.h"
#include "planner/ocp/arm_ocp.h"
#include "planner/ocp/collocate.h"
#include "planner/ocp/margins.h"
#include "planner/problem/task/task.h"

namespace fjr {

// A bound that represents a limit at every collocation point of an interval.
struct BoundOfLimit {
  std::size_t limit;  // as in PerLimit
  enum Of { kState, kControl, kRow } of;
  int index;
  bool upper;
  double value;
  double size;   // tolerances are fractions of this
  double slope;  // d value / d limit; for a task constraint: d value / d clearance
};

// Returns the bounds that represent the limits. Their slopes are central differences, which are exact because the
// bounds are polynomials of degree <= 2 in the limits (path_bounds()). scales: limit_scales().
template <Features F>
std::vector<BoundOfLimit> bounds_of_limits(const TightenedLimits& tightened, const PerLimit& scales) {
  constexpr double kStep = 1.0 / 1024;
  const Limits& limits = tightened.limits;
  const auto at = path_bounds<F>(limits);
  std::vector<BoundOfLimit> bounds;
  for (std::size_t i = 0; i < kLimits; ++i) {
    const double limit = kLimitNames[i].in(limits);
    if (!std::isfinite(limit)) continue;
    Limits less = limits, more = limits;
    kLimitNames[i].in(less) -= kStep * limit;
    kLimitNames[i].in(more) += kStep * limit;
    const auto low = path_bounds<F>(less), high = path_bounds<F>(more);
    const auto compare = [&](BoundOfLimit::Of of, bool upper, const auto& value, const auto& below, const auto& above) {
      for (std::size_t n = 0; n < value.size(); ++n) {
        if (below[n] == above[n]) continue;
        const bool off_zero = kLimitNames[i].quantity->counted_from(limits, kLimitNames[i].j()) != 0;
        bounds.push_back({i, of, static_cast<int>(n), upper, value[n], off_zero ? limit : std::abs(value[n]),
                          (above[n] - below[n]) / (2 * kStep * limit)});
      }
    };
    compare(BoundOfLimit::kState, false, at.x_lower, low.x_lower, high.x_lower);
    compare(BoundOfLimit::kState, true, at.x_upper, low.x_upper, high.x_upper);
    compare(BoundOfLimit::kControl, false, at.u_lower, low.u_lower, high.u_lower);
    compare(BoundOfLimit::kControl, true, at.u_upper, low.u_upper, high.u_upper);
    compare(BoundOfLimit::kRow, false, at.row_lower, low.row_lower, high.row_lower);
    compare(BoundOfLimit::kRow, true, at.row_upper, low.row_upper, high.row_upper);
  }
  for (std::size_t r = 0; r < tightened.task_rows.size(); ++r) {
    const std::size_t i = kLimits + r;
    const int row = ArmOcp<F>::kTask + static_cast<int>(r);
    for (const bool upper : {false, true}) {
      const double value = tightened.task_rows[r][upper ? 1 : 0];
      if (std::isfinite(value))
        bounds.push_back({i, BoundOfLimit::kRow, row, upper, value, scales[i], upper ? 1.0 : -1.0});
    }
  }
  return bounds;
}

template <Features F>
class ShadowPrices {
 public:
  using T = Transcription<ArmOcp<F>>;

  ShadowPrices(const Problem& problem, const CollocationSetup& setup, const T& t, const Iterate& solution)
      : t_(t),
        solution_(solution),
        tightened_(tightened_limits(problem, setup.mesh, setup.margins)),
        scales_(limit_scales(problem)) {
    counted_variable_.assign(static_cast<std::size_t>(t.variables()), 0);
    counted_row_.assign(static_cast<std::size_t>(t.constraints()), 0);
    rows_.resize(t.constraints());
    t.constraint_values(solution.x, rows_);
    name_all(problem);
  }

  std::vector<ShadowPrice> run() {
    const std::vector<double> nodes = t_.mesh().node_times(t_.durations(solution_.x));
    const Eigen::VectorXd& b = t_.scheme().b;
    std::vector<BoundOfLimit> bounds;
    for (int k = 0; k < t_.intervals(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (k == 0 || !same(tightened_[at], tightened_[at - 1])) bounds = bounds_of_limits<F>(tightened_[at], scales_);
      double time = nodes[at];  // each collocation point represents a part of the interval as long as its weight
      for (int j = 0; j < t_.scheme().stages(); ++j) {
        const double end = j + 1 == t_.scheme().stages() ? nodes[at + 1] : time + b(j) * (nodes[at + 1] - nodes[at]);
        for (const BoundOfLimit& bound : bounds) {
          if (visit(k, j, bound)) prices_[bound.limit].active.push_back({time, end});
        }
        time = end;
      }
    }
    std::vector<ShadowPrice> result;
    for (ShadowPrice& price : prices_) {
      if (!std::isfinite(price.limit)) continue;
      const bool more = continues_constraint(price.index);
      if (!more) result.push_back(price);
      if (more) result.back().price += price.price;
      if (more) std::copy(price.active.begin(), price.active.end(), std::back_inserter(result.back().active));
    }
    for (ShadowPrice& price : result) {
      price.active = joined(std::move(price.active), kGap * nodes.back());
      for (const auto& stretch : price.active) price.fraction += (stretch.end - stretch.begin) / nodes.back();
    }
    return result;
  }

 private:
  void name_all(const Problem& problem) {
    for (const LimitName& limit : kLimitNames) {
      const QuantityInfo& info = *limit.quantity;
      prices_.push_back({info.name, limit.joint, info.unit, limit.in(problem.limits), 0, 0, {}, prices_.size()});
    }
    for (const TaskRow& row : task_rows(problem.robot, problem.task, 0)) {
      prices_.push_back({row.name, row.link, row.unit(), row.scale, 0, 0, {}, prices_.size()});
      constraints_.push_back({row.constraint, row.link});
    }
  }

  // Returns whether a row belongs to the same task constraint and link as the row before it. Such rows have one price.
  bool continues_constraint(std::size_t index) const {
    return index > kLimits && constraints_[index - kLimits] == constraints_[index - kLimits - 1];
  }

  static constexpr double kGap = 0.01;  // fraction of the duration; shorter interruptions are ignored

  static bool same(const TightenedLimits& a, const TightenedLimits& b) {
    return a.limits == b.limits && a.task_rows == b.task_rows;
  }

  static std::vector<ShadowPrice::Stretch> joined(std::vector<ShadowPrice::Stretch> parts, double gap) {
    std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    std::vector<ShadowPrice::Stretch> stretches;
    for (const auto& part : parts) {
      if (stretches.empty() || part.begin - stretches.back().end > gap) stretches.push_back(part);
      stretches.back().end = std::max(stretches.back().end, part.end);
    }
    return stretches;
  }

  // Returns whether the bound is active at stage j. If so, its multiplier is added to the limit's price, but only once.
  bool visit(int k, int j, const BoundOfLimit& bound) {
    if (bound.of == BoundOfLimit::kState) return variable(t_.x_at(k, j) + bound.index, bound);
    if (bound.of == BoundOfLimit::kRow) return row(k, j, bound);
    bool active = false;
    for (int end = 0; end < 2; ++end) {
      if (t_.scheme().control_fraction(j, end) < 0.5) continue;
      active = variable(t_.u_at(k, end) + bound.index, bound) || active;
    }
    return active;
  }

  bool variable(int at, const BoundOfLimit& bound) {
    if (t_.x_lower(at) == t_.x_upper(at)) return false;  // fixed by the request
    const double present = bound.upper ? t_.x_upper(at) : t_.x_lower(at);
    if (!active(present, solution_.x(at), bound)) return false;
    char& counted = counted_variable_[static_cast<std::size_t>(at)];
    if (!counted) add(bound, bound.upper ? solution_.z_upper(at) : -solution_.z_lower(at));
    counted = 1;
    return true;
  }

  bool row(int k, int j, const BoundOfLimit& bound) {
    int row = t_.path_row(k, j, bound.index);
    const auto segment = [this](int i) { return t_.mesh().intervals[static_cast<std::size_t>(i)].segment; };
    if (row < 0 && j == 0 && k > 0 && t_.scheme().starts_at_node &&
        segment(k) == segment(k - 1)) {  // imposed once, at the end of the interval before
      row = t_.path_row(k - 1, t_.scheme().stages() - 1, bound.index);
    }
    if (row < 0 || !active(bound.upper ? t_.g_upper(row) : t_.g_lower(row), rows_(row), bound)) return false;
    char& counted = counted_row_[static_cast<std::size_t>(row)];
    const double lambda = solution_.lambda(row);
    if (!counted) add(bound, bound.upper ? std::max(lambda, 0.0) : std::min(lambda, 0.0));
    counted = 1;
    return true;
  }

  // Returns whether the bound is active. present: the actual bound, which may come from another limit or a fixed value.
  static bool active(double present, double value, const BoundOfLimit& bound) {
    return std::abs(present - bound.value) <= 1e-12 * bound.size &&
           std::abs(value - bound.value) <= kActive * bound.size;
  }

  // multiplier: -d objective / d bound.
  void add(const BoundOfLimit& bound, double multiplier) { prices_[bound.limit].price += multiplier * bound.slope; }

  const T& t_;
  const Iterate& solution_;
  std::vector<TightenedLimits> tightened_;
  PerLimit scales_;
  Eigen::VectorXd rows_;
  std::vector<std::pair<std::size_t, int>> constraints_;  // per row of the task: its constraint and link
  std::vector<char> counted_variable_, counted_row_;
  std::vector<ShadowPrice> prices_;  // in the order of PerLimit
};

}  // namespace fjr
