// Enclosures of the solutions of x' = f(x, u(t)), u a polynomial: Taylor series with remainder in a set that is kept
// narrow by a moving orthogonal basis.
//
// A step of length h from the set {center + edges s + basis r : |s_j| <= old_j, |r_j| <= young_j}, whose hull is the
// box X:
// 1. a priori enclosure of order p: a box E with sum_(k<p) X^[k] [0,h]^k + E^[p] [0,h^p] in E holds every solution that
//    starts in X, over all of [0, h]. X^[k], E^[k]: the k-th Taylor coefficient over the box.
// 2. center and set apart, by the mean value form:
//      x(h) in sum_(k<p) center^[k] h^k + J (edges s + basis r) + E^[p] h^p,  J = sum_(k<p) dX^[k]/dx h^k
// 3. The edges are transported without wrapping them in a box. The errors (roundings, remainders, the width of J) go
//    into the second part, whose next basis is the orthogonal factor of the transported one, longest first. Only when
//    the second part has outgrown the first, the first is wrapped in it and it becomes the first.
// Lohner, Computation of guaranteed enclosures for the solutions of ordinary initial and boundary value problems
// (1992); Corliss & Rihm (1996) for 1.; Nedialkov, Jackson & Corliss, Applied Mathematics and Computation 105 (1999).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/enclosure/ball.h"
#include "common/enclosure/recording.h"
#include "common/enclosure/set.h"
#include "common/enclosure/taylor.h"

namespace enclosure {

using Polynomial = std::vector<Ball>;  // coefficients of powers of time

// Returns the coefficients of the polynomial in t - by.
inline Polynomial shifted(Polynomial c, const Ball& by) {
  for (std::size_t i = 0; i + 1 < c.size(); ++i) {
    for (std::size_t k = c.size() - 1; k-- > i;) c[k] += by * c[k + 1];
  }
  return c;
}

// The solutions over one step, from `from` on: x_i(from + t) in sum_k near[i][k] t^k for t in [0, length], of which the
// last coefficient holds the remainder; and Taylor coefficients over[i] at any instant of the step, of which the first
// holds the solution itself.
template <std::size_t N>
struct Step {
  Ball from, length;
  std::array<Polynomial, N> near, over;
};

// Taylor coefficients up to `order` of the solution from x, of all nodes; the last ones of the outputs are left out.
template <std::size_t N>
void expand(Series& s, const Balls<N>& x, const std::vector<Polynomial>& signals, std::size_t order) {
  for (std::size_t i = 0; i < N; ++i) s.at(i, 0) = x[i];
  for (std::size_t j = 0; j < signals.size(); ++j) {
    for (std::size_t k = 0; k <= order; ++k) s.at(N + j, k) = k < signals[j].size() ? signals[j][k] : Ball{};
  }
  for (std::size_t k = 0; k < order; ++k) {
    s.compute(k);
    for (std::size_t i = 0; i < N; ++i) s.at(i, k + 1) = s.output(i, k) / Ball(static_cast<double>(k + 1));
  }
}

struct FlowOptions {
  std::size_t order = 12;        // p
  std::size_t slope_order = 12;  // of the derivatives of the flow; what is left out is enclosed over the box
  double remainder = 1e-16;      // that a step may add to a component of size 1
  double shortest = 1e-12;       // of a step; the enclosure has failed where that is too long
};

template <std::size_t N>
class Flow {
 public:
  // f: N + signals inputs, N outputs; it must outlive the flow.
  explicit Flow(const Recording& f, const FlowOptions& options = {})
      : options_(options),
        point_(f, options.slope_order),
        box_(f, options.order),
        ahead_(f, options.order),
        slopes_(f, options.slope_order) {}

  void start(const Set<N>& set) { set_ = set; }
  void start(const Balls<N>& box) { start(Set<N>(box)); }
  const Set<N>& set() const { return set_; }
  long steps() const { return steps_; }

  // Encloses the solutions for `duration` under these signals, and calls observe(Step) for each step. Returns false if
  // no enclosure is found from reached() on, or if observe returned false.
  template <class Observe>
  bool run(const std::vector<Polynomial>& signals, const Ball& duration, Observe&& observe) {
    reached_ = 0;
    while (reached_ < duration.upper()) {
      const bool seen = step(signals, duration) && observe(static_cast<const Step<N>&>(last_));
      if (!seen) return false;
      if (is_last_) break;
      reached_ = next_;
    }
    return true;
  }
  // Returns the time [s] from the beginning of the last run up to which solutions are enclosed.
  double reached() const { return reached_; }

 private:
  bool step(const std::vector<Polynomial>& signals, const Ball& duration) {
    ++steps_;
    const Balls<N> hull = set_.hull();
    std::vector<Polynomial> now;
    for (const Polynomial& signal : signals) now.push_back(shifted(signal, reached_));
    Balls<N> center;
    for (std::size_t i = 0; i < N; ++i) center[i] = set_.center()[i];
    expand(point_, center, now, slope_order());
    expand(box_, hull, now, options_.order);
    const double left = duration.upper() - reached_;
    double h = std::min({length_by_decay(), longer_ * usual_, left});
    longer_ = std::min(kLonger, kRegained * longer_);
    for (;; h = h > usual_ ? usual_ : kShorter * h) {
      if (h < left && !(h > options_.shortest)) return false;
      choose_end(h, duration);
      if (enclose(signals)) break;
      longer_ = 1;
    }
    usual_ = is_last_ ? std::max(usual_, h) : h;
    wider_ = std::max(1.0, kForgotten * wider_);
    tell();
    return transport();
  }

  std::size_t slope_order() const { return std::min(options_.slope_order, options_.order - 1); }

  // Chooses the end of the step, and sets its exact length.
  void choose_end(double h, const Ball& duration) {
    next_ = reached_ + h;
    is_last_ = next_ >= duration.lower() - 0.1 * h;
    last_.from = reached_;
    last_.length = (is_last_ ? duration : Ball(next_)) - Ball(reached_);
  }

  // Returns the step length for which the last coefficients reach the allowed remainder.
  double length_by_decay() const {
    double h = 1e300;
    for (const std::size_t k : {options_.order - 1, options_.order}) {
      for (std::size_t i = 0; i < N; ++i) {
        const double c = std::abs(box_.at(i, k).mid);
        if (c > 0) h = std::min(h, std::pow(allowed(i) / c, 1.0 / static_cast<double>(k)));
      }
    }
    return h;
  }
  double allowed(std::size_t i) const { return options_.remainder * (1 + std::abs(set_.center()[i])); }

  // Returns an enclosure of t^k for all t in the step.
  Ball power(std::size_t k) const {
    double p = 1;
    const double h = last_.length.upper();
    for (std::size_t j = 0; j < k; ++j) p = rounded_up(p * h);
    return k == 0 ? Ball(1) : Ball::between(0, p);
  }

  // Step 1 above. Returns true if a box with a sufficiently small remainder is found.
  bool enclose(const std::vector<Polynomial>& signals) {
    const std::size_t p = options_.order;
    const Ball whole = last_.from + power(1), last_power = power(p);
    std::vector<Polynomial> during;
    for (const Polynomial& signal : signals) during.push_back(shifted(signal, whole));
    Balls<N> without, tried;
    for (std::size_t i = 0; i < N; ++i) {
      without[i] = box_.at(i, 0);
      for (std::size_t k = 1; k < p; ++k) without[i] += box_.at(i, k) * power(k);
      const double predicted = 4 * std::abs(box_.at(i, p).mid) * last_power.magnitude() + allowed(i);
      tried[i] = without[i] + Ball(0, wider_ * predicted);
    }
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      expand(ahead_, tried, during, p);
      bool inside = true, small = true;
      for (std::size_t i = 0; i < N; ++i) {
        const Ball remainder = ahead_.at(i, p) * last_power;
        const Ball box = without[i] + remainder;
        small = small && remainder.magnitude() <= kSlack * allowed(i);
        if (!tried[i].contains(box)) {
          inside = false;
          tried[i] = without[i] + Ball(0, 2 * remainder.magnitude());
        }
      }
      if (!small) return false;
      if (inside) return true;
      wider_ = kWider;
    }
    return false;
  }

  // Provides the series of the step to the observer.
  void tell() {
    const std::size_t p = options_.order;
    for (std::size_t i = 0; i < N; ++i) {
      last_.near[i].resize(p + 1);
      last_.over[i].resize(p + 1);
      for (std::size_t k = 0; k <= p; ++k) {
        last_.over[i][k] = ahead_.at(i, k);
        last_.near[i][k] = k < p ? box_.at(i, k) : ahead_.at(i, k);
      }
    }
  }

  // Steps 2 and 3 above.
  bool transport() {
    const std::size_t p = options_.order, q = slope_order();
    Balls<N> center{};
    BallMatrix<N> jacobian{};
    expand_slopes(q);
    std::vector<Ball> powers{Ball(1)};
    for (std::size_t k = 1; k <= p; ++k) powers.push_back(powers.back() * last_.length);
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t k = p + 1; k-- > 0;) {
        const Ball& c = k == p ? ahead_.at(i, k) : k <= q ? point_.at(i, k) : box_.at(i, k);
        center[i] += c * powers[k];
      }
      for (std::size_t k = q + 1; k-- > 0;) {
        for (std::size_t j = 0; j < N; ++j) jacobian[i][j] += slopes_.at(i, k)[j] * powers[k];
      }
    }
    return set_.move(center, jacobian);
  }

  // Computes the derivatives of the Taylor coefficients over the box by the state.
  void expand_slopes(std::size_t order) {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) slopes_.at(i, 0).set(j, i == j ? 1.0 : 0.0);
    }
    for (std::size_t k = 0; k < order; ++k) {
      slopes_.compute(box_, k);
      const Ball next = Ball(1) / Ball(static_cast<double>(k + 1));
      for (std::size_t i = 0; i < N; ++i) {
        const Slope<N>& rate = slopes_.at(box_.function().outputs()[i], k);
        for (std::size_t j = 0; j < N; ++j) slopes_.at(i, k + 1).set(j, rate[j] * next);
      }
    }
  }

  // Factors of the step length; kForgotten is that of wider_, per step. A failed attempt costs as much as a step, so
  // the length grows slowly where attempts fail, as in steep friction.
  static constexpr double kShorter = 0.8, kLonger = 1.5, kRegained = 1.05, kForgotten = 0.999;
  static constexpr double kSlack = 4;    // factor by which a remainder may exceed allowed()
  static constexpr double kWider = 4.4;  // kSlack and rounding: such a box is accepted at once or not at all
  static constexpr int kAttempts = 3;

  FlowOptions options_;
  Series point_, box_, ahead_;  // from the center, over the set's hull, over the whole step
  Slopes<N> slopes_;
  Set<N> set_;
  Step<N> last_;
  double reached_ = 0, next_ = 0;
  double usual_ = 1e300;     // length of the last step that was not shortened by the end of a run
  double longer_ = kLonger;  // factor by which the next step may be longer
  double wider_ = 1;         // factor of the first box to the predicted one; grows where that was too small
  bool is_last_ = false;
  long steps_ = 0;
};

}  // namespace enclosure
