// Enclosures for the case that one component of x' = f(x, u(t)) decays fast to a value driven by the others, such as
// the velocity of a motor in steep friction. A Taylor series would be limited to steps of a few of its time constants.
// Instead the component v is compared with a polynomial w(t), to which it stays close.
//
// On [0, H], with e = v - w, F the rate of v, and x the others:
//    e' = F(w + e, x) - w' = r(t) + F_v e,   |r(t)| = |F(w(t), x(t)) - w'(t)| <= rho,   F_v <= -lambda < 0
//    so |e(t)| <= |e(0)| exp(-lambda t) + rho / lambda                                            (Gronwall)
// The others see v as w and a disturbance. With x* the motion under w alone, |x - x*| is in every component at most
//    D = exp(M H) |df/dv| (|e(0)| / lambda + H rho / lambda),   M_ij >= |df_i/dx_j|, M_ii >= max(0, df_i/dx_i)
// All bounds hold on the box spanned by x*, D and e. While the motion is in the box, it satisfies the bounds and so
// stays inside; therefore it never leaves the box. w may be any polynomial; one found by collocation makes rho small.
// Zgliczynski & Kapela, Topological Methods in Nonlinear Analysis 34 (2009): perturbed motions by logarithmic norms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "common/enclosure/ball.h"
#include "common/enclosure/flow.h"
#include "common/enclosure/recording.h"
#include "common/enclosure/set.h"
#include "common/enclosure/taylor.h"

namespace enclosure {

// The result of the attempt to enclose a motion with one component held near a polynomial.
enum class Holding {
  kNotHeld,  // it does not decay fast enough, or no bounds were found; the set is unchanged, observe was not called
  kHeld,     // the whole duration was enclosed
  kStopped   // the observer returned false
};

template <std::size_t N>
class HeldFlow {
 public:
  // f: N + signals inputs, N outputs, as for a Flow; it must outlive this. held: the component.
  HeldFlow(const Recording& f, std::size_t held, const FlowOptions& options = {})
      : held_(held),
        options_(options),
        without_(f.with_given(held)),
        rate_(f.only(held)),
        flow_(without_, options),
        guess_(without_, kGuessOrder),
        point_(rate_, 0),
        near_(rate_, options.order),
        over_(rate_, options.order),
        box_(f, 0),
        slopes_(f, 0) {}
  HeldFlow(const HeldFlow&) = delete;
  HeldFlow& operator=(const HeldFlow&) = delete;

  // If the component can be held, encloses the solutions that start in the set for `duration` under these signals,
  // calls observe(Step) for each step, and moves the set.
  template <class Observe>
  Holding run(Set<N>& set, const std::vector<Polynomial>& signals, const Ball& duration, Observe&& observe) {
    const double rate = rate_at(set.center(), signals, 0);
    if (!(rate * duration.mid < -kWorthIt)) return Holding::kNotHeld;
    if (!choose_middle(set.center(), signals, duration.mid)) return Holding::kNotHeld;
    const double beside = std::abs(set.center()[held_] - middle_[0].mid);
    if (beside > options_.remainder * std::abs(rate)) return Holding::kNotHeld;  // it has to decay first
    if (!follow(set, signals, duration) || !bound(set, signals, duration)) return Holding::kNotHeld;
    Set<N> moved = flow_.set();
    if (!move(moved, duration)) return Holding::kNotHeld;
    for (const Step<N>& step : steps_) {
      reached_ = step.from.mid;
      if (!observe(widened(step))) return Holding::kStopped;
    }
    set = moved;
    return Holding::kHeld;
  }
  // Returns the time [s] from the beginning of the last run at which it was stopped.
  double reached() const { return reached_; }
  // Returns the number of steps so far, which are those of x*; holding the component takes none of its own.
  long steps() const { return flow_.steps(); }

 private:
  static constexpr std::size_t kNodes = 6;       // of the collocation: w has degree 5
  static constexpr std::size_t kGuessOrder = 6;  // of the motion that it is found for
  static constexpr double kWorthIt = 12;         // time constants for which a Taylor series would cost as much
  static constexpr int kNewton = 8, kAttempts = 3;
  using Values = std::array<double, kNodes>;

  // ---- w, in floating point: its accuracy affects only the width of the bounds, not their validity ----

  // The held component's rate, its derivative by the component, at a state and signals.
  double rate_at(const std::array<double, N>& x, const std::vector<Polynomial>& signals, double time) {
    constexpr double kApart = 1e-7;
    std::array<double, N> more = x;
    const double step = kApart * std::max(kApart, std::abs(x[held_]));
    more[held_] += step;
    return (rate(more, signals, time) - rate(x, signals, time)) / step;
  }
  double rate(const std::array<double, N>& x, const std::vector<Polynomial>& signals, double time) {
    for (std::size_t i = 0; i < N; ++i) point_.at(i, 0) = x[i];
    for (std::size_t j = 0; j < signals.size(); ++j) point_.at(N + j, 0) = value(signals[j], time);
    point_.compute(0);
    return point_.output(0, 0).mid;
  }
  static double value(const Polynomial& c, double time) {
    double sum = 0;
    for (std::size_t k = c.size(); k-- > 0;) sum = sum * time + c[k].mid;
    return sum;
  }

  // Solves w' = F(w, x(t)) at the Gauss-Chebyshev nodes without an initial value; with a steep rate this has one smooth
  // solution. It is done twice, because the other components depend on w.
  bool choose_middle(const std::array<double, N>& center, const std::vector<Polynomial>& signals, double duration) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double angle = std::numbers::pi * (static_cast<double>(i) + 0.5) / kNodes;
      nodes_[i] = 0.5 * duration * (1 - std::cos(angle));
    }
    middle_ = {center[held_]};
    for (int pass = 0; pass < 2; ++pass) {
      follow_roughly(center, signals);
      Values w;
      for (std::size_t i = 0; i < kNodes; ++i) w[i] = value(middle_, nodes_[i]);
      if (!collocate(signals, w)) return false;
      interpolate(w);
    }
    return true;
  }
  void follow_roughly(const std::array<double, N>& center, const std::vector<Polynomial>& signals) {
    Balls<N> x;
    std::copy(center.begin(), center.end(), x.begin());
    expand(guess_, x, with_middle(signals), kGuessOrder);
    for (std::size_t n = 0; n < kNodes; ++n) {
      for (std::size_t i = 0; i < N; ++i) {
        double sum = 0;
        for (std::size_t k = kGuessOrder + 1; k-- > 0;) sum = sum * nodes_[n] + guess_.at(i, k).mid;
        rough_[n][i] = sum;
      }
    }
  }
  bool collocate(const std::vector<Polynomial>& signals, Values& w) {
    const auto slope = differentiation();
    for (int iteration = 0; iteration < kNewton; ++iteration) {
      std::array<Values, kNodes> jacobian = slope;
      Values left{};
      for (std::size_t i = 0; i < kNodes; ++i) {
        rough_[i][held_] = w[i];
        left[i] = rate(rough_[i], signals, nodes_[i]);
        for (std::size_t j = 0; j < kNodes; ++j) left[i] -= slope[i][j] * w[j];
        jacobian[i][i] -= rate_at(rough_[i], signals, nodes_[i]);
      }
      if (!solve(jacobian, left)) return false;
      double change = 0, size = 0;
      for (std::size_t i = 0; i < kNodes; ++i) {
        w[i] += left[i];
        change = std::max(change, std::abs(left[i]));
        size = std::max(size, std::abs(w[i]));
      }
      if (!(change < 1e280)) return false;
      if (change <= 1e-13 * size) return true;
    }
    return true;
  }
  // Returns the matrix that differentiates the polynomial through values at the nodes.
  std::array<Values, kNodes> differentiation() const {
    std::array<Values, kNodes> d{};
    Values weight;
    for (std::size_t i = 0; i < kNodes; ++i) {
      weight[i] = 1;
      for (std::size_t j = 0; j < kNodes; ++j) {
        if (j != i) weight[i] *= nodes_[i] - nodes_[j];
      }
    }
    for (std::size_t i = 0; i < kNodes; ++i) {
      for (std::size_t j = 0; j < kNodes; ++j) {
        if (j == i) continue;
        d[i][j] = weight[i] / weight[j] / (nodes_[i] - nodes_[j]);
        d[i][i] += 1 / (nodes_[i] - nodes_[j]);
      }
    }
    return d;
  }
  // Newton's divided differences, multiplied out.
  void interpolate(Values w) {
    for (std::size_t order = 1; order < kNodes; ++order) {
      for (std::size_t i = kNodes; i-- > order;) w[i] = (w[i] - w[i - 1]) / (nodes_[i] - nodes_[i - order]);
    }
    Values c{};
    for (std::size_t i = kNodes; i-- > 0;) {
      for (std::size_t k = kNodes - 1; k > 0; --k) c[k] = c[k - 1] - nodes_[i] * c[k];
      c[0] = w[i] - nodes_[i] * c[0];
    }
    middle_.assign(c.begin(), c.end());
  }
  // Replaces b by a^-1 b by Gaussian elimination with pivoting.
  static bool solve(std::array<Values, kNodes>& a, Values& b) {
    for (std::size_t k = 0; k < kNodes; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < kNodes; ++i) {
        if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
      }
      if (!(std::abs(a[pivot][k]) > 0)) return false;
      std::swap(a[k], a[pivot]);
      std::swap(b[k], b[pivot]);
      for (std::size_t i = k + 1; i < kNodes; ++i) {
        const double factor = a[i][k] / a[k][k];
        for (std::size_t j = k; j < kNodes; ++j) a[i][j] -= factor * a[k][j];
        b[i] -= factor * b[k];
      }
    }
    for (std::size_t k = kNodes; k-- > 0;) {
      for (std::size_t j = k + 1; j < kNodes; ++j) b[k] -= a[k][j] * b[j];
      b[k] /= a[k][k];
    }
    return true;
  }

  // ---- bounds ----

  // w' with coefficients that hold the exact ones.
  Polynomial middle_rate() const {
    Polynomial rate;
    for (std::size_t k = 1; k < middle_.size(); ++k) rate.push_back(middle_[k] * Ball(static_cast<double>(k)));
    if (rate.empty()) rate.push_back(0.0);
    return rate;
  }
  std::vector<Polynomial> with_middle(std::vector<Polynomial> signals) const {
    signals.push_back(middle_);
    signals.push_back(middle_rate());
    return signals;
  }

  // x*, step by step.
  bool follow(const Set<N>& set, const std::vector<Polynomial>& signals, const Ball& duration) {
    steps_.clear();
    flow_.start(set);
    return flow_.run(with_middle(signals), duration, [this](const Step<N>& step) {
      steps_.push_back(step);
      return true;
    });
  }

  // lambda, rho and D, which hold if they are within those that they were found for.
  bool bound(const Set<N>& set, const std::vector<Polynomial>& signals, const Ball& duration) {
    const double at_first = (set.hull()[held_] - middle_[0]).magnitude();
    double may_be_off = rounded_up(2 * at_first + options_.remainder);
    std::array<double, N> may_differ{};
    may_differ.fill(may_be_off * duration.upper());
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      off_ = may_be_off;
      apart_ = may_differ;
      if (!find_slopes(signals)) return false;
      const double defect = largest_defect(signals);
      const double beside = (Ball(defect) / Ball(decay_)).magnitude();
      const double most = rounded_up(at_first + beside);
      const Ball time = (Ball(at_first) + duration * Ball(defect)) / Ball(decay_);  // integral of |e|
      const std::array<double, N> differ = differences(time.magnitude(), duration.upper());
      at_last_ = rounded_up((Ball(at_first) * exp(-(Ball(decay_) * duration))).magnitude() + beside);
      bool fits = most <= may_be_off;
      for (std::size_t i = 0; i < N; ++i) fits = fits && (i == held_ || differ[i] <= may_differ[i]);
      if (!(most < kLargest)) return false;
      if (fits) {
        off_ = most;
        apart_ = differ;
        return is_small_enough(set);
      }
      may_be_off = std::max(may_be_off, 2 * most);
      for (std::size_t i = 0; i < N; ++i) may_differ[i] = std::max(may_differ[i], 2 * differ[i]);
    }
    return false;
  }

  // Returns whether the bounds widen the set by no more than a step of a Taylor series may.
  bool is_small_enough(const Set<N>& set) const {
    for (std::size_t i = 0; i < N; ++i) {
      if (i != held_ && apart_[i] > options_.remainder * (1 + std::abs(set.center()[i]))) return false;
    }
    return true;
  }

  // The middle in the time since `by`.
  Polynomial middle_from(const Ball& by, double off) const {
    Polynomial c = shifted(middle_, by);
    c[0] += Ball(0, off);
    return c;
  }
  static Ball whole(const Step<N>& step) { return step.from + Ball::between(0, step.length.upper()); }

  // Bounds df/dx over the box: the decay rate lambda of the component, and M for the others.
  bool find_slopes(const std::vector<Polynomial>& signals) {
    decay_ = 1e300;
    for (auto& row : growth_) row.fill(0);
    for (const Step<N>& step : steps_) {
      for (std::size_t i = 0; i < N; ++i) box_.at(i, 0) = step.over[i][0] + Ball(0, apart_[i]);
      box_.at(held_, 0) = middle_from(whole(step), off_)[0];
      for (std::size_t j = 0; j < signals.size(); ++j) box_.at(N + j, 0) = shifted(signals[j], whole(step))[0];
      box_.compute(0);
      for (std::size_t i = 0; i < N; ++i) {
        for (std::size_t j = 0; j < N; ++j) slopes_.at(i, 0).set(j, i == j ? 1.0 : 0.0);
      }
      slopes_.compute(box_, 0);
      for (std::size_t i = 0; i < N; ++i) {
        const Slope<N>& row = slopes_.at(box_.function().outputs()[i], 0);
        for (std::size_t j = 0; j < N; ++j) {
          if (!row[j].is_bounded()) return false;
          const double entry = i == j ? std::max(0.0, row[j].upper()) : row[j].magnitude();
          growth_[i][j] = std::max(growth_[i][j], entry);
          if (i == held_ && j == held_) decay_ = std::min(decay_, -row[j].upper());
        }
      }
    }
    return decay_ > 0;
  }

  // rho: of F(w, x) - w' over every step, as a polynomial about its beginning with a remainder.
  double largest_defect(const std::vector<Polynomial>& signals) {
    const Polynomial rate = middle_rate();
    double most = 0;
    for (const Step<N>& step : steps_) {
      set_inputs(near_, step.near, signals, step.from);
      set_inputs(over_, step.over, signals, whole(step));
      const std::size_t p = options_.order;
      for (std::size_t k = 0; k < p; ++k) near_.compute(k);
      for (std::size_t k = 0; k <= p; ++k) over_.compute(k);
      const Polynomial here = shifted(rate, step.from);
      double sum = 0;
      for (std::size_t k = p + 1; k-- > 0;) {
        Ball c = k == p ? over_.output(0, k) : near_.output(0, k);
        if (k < here.size()) c -= here[k];
        sum = rounded_up(sum * step.length.upper() + c.magnitude());
      }
      most = std::max(most, std::isfinite(sum) ? sum : 2 * kLargest);
    }
    return most;
  }
  void set_inputs(Series& s, const std::array<Polynomial, N>& x, const std::vector<Polynomial>& signals,
                  const Ball& since) const {
    const std::size_t p = options_.order;
    const auto set = [&](std::size_t input, const Polynomial& c) {
      for (std::size_t k = 0; k <= p; ++k) s.at(input, k) = k < c.size() ? c[k] : Ball{};
    };
    for (std::size_t i = 0; i < N; ++i) {
      set(i, x[i]);
      s.at(i, 0) += Ball(0, apart_[i]);
    }
    set(held_, middle_from(since, 0));
    for (std::size_t j = 0; j < signals.size(); ++j) set(N + j, shifted(signals[j], since));
  }

  // Returns D for a disturbance with the given integral, with the series of the exponential. Beyond the summed terms
  // each is at most half of the one before, so all of them together are less than twice the next.
  std::array<double, N> differences(double integral, double duration) const {
    constexpr int kTerms = 16;
    constexpr double kMost = 50;  // of |M H|
    std::array<double, N> sum{}, term{};
    double norm = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (i == held_) continue;
      term[i] = rounded_up(growth_[i][held_] * integral);
      double row = 0;
      for (std::size_t j = 0; j < N; ++j) row = rounded_up(row + (j == held_ ? 0 : growth_[i][j] * duration));
      norm = std::max(norm, row);
    }
    if (!(norm < kMost)) {
      sum.fill(2 * kLargest);
      return sum;
    }
    const int terms = kTerms + static_cast<int>(2 * norm) + 1;
    for (int k = 1; k <= terms; ++k) {
      std::array<double, N> next{};
      for (std::size_t i = 0; i < N; ++i) {
        sum[i] = rounded_up(sum[i] + term[i]);
        for (std::size_t j = 0; j < N; ++j) {
          if (i != held_ && j != held_) next[i] = rounded_up(next[i] + growth_[i][j] * term[j] * duration / k);
        }
      }
      term = next;
    }
    const double rest = 2 * *std::max_element(term.begin(), term.end());
    for (double& s : sum) s = rounded_up(s + rest);
    return sum;
  }

  // Widens a step of x* for the observer by the bounds on the distance between the motion and x*.
  Step<N> widened(Step<N> step) const {
    for (std::size_t i = 0; i < N; ++i) {
      step.near[i][0] += Ball(0, apart_[i]);
      step.over[i][0] += Ball(0, apart_[i]);
    }
    const std::size_t size = options_.order + 1;
    step.near[held_] = middle_from(step.from, off_);
    step.over[held_] = middle_from(whole(step), off_);
    step.near[held_].resize(size);
    step.over[held_].resize(size);
    return step;
  }

  // Makes the set of x* at the end that of the motion. The held component no longer depends on its initial value.
  bool move(Set<N>& set, const Ball& duration) const {
    Balls<N> center;
    BallMatrix<N> map{};
    for (std::size_t i = 0; i < N; ++i) {
      center[i] = {set.center()[i], apart_[i]};
      map[i][i] = i == held_ ? 0.0 : 1.0;
    }
    center[held_] = polynomial(middle_, middle_.size(), duration) + Ball(0, at_last_);
    return set.move(center, map);
  }

  std::size_t held_;
  FlowOptions options_;
  Recording without_;  // f with the component and its rate given as signals
  Recording rate_;     // the component's alone
  Flow<N> flow_;
  Series guess_;                // of the motion, roughly
  Series point_, near_, over_;  // of the component's rate: at an instant, from the beginning of a step, over all of it
  Series box_;                  // of f, over all of a step
  Slopes<N> slopes_;
  Values nodes_{};
  std::array<std::array<double, N>, kNodes> rough_{};  // states of the rough motion at the nodes
  Polynomial middle_;                                  // w
  std::vector<Step<N>> steps_;                         // of x*
  std::array<std::array<double, N>, N> growth_{};      // M, and |df/dv|
  double decay_ = 0;                                   // lambda
  double off_ = 0, at_last_ = 0;                       // bounds of |e|, at any time and at the end
  std::array<double, N> apart_{};                      // D
  double reached_ = 0;
};

}  // namespace enclosure
