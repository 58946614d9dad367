// The acceptance test of a filter line search (Wächter & Biegler, sections 2.3 and 2.4): a trial point must have less
// constraint violation or a lower barrier function than the current point and than every earlier point in the filter.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fjr {

// The constraint violation (1-norm) and the barrier function at a point.
struct Merit {
  double violation, barrier;
};

class Filter {
 public:
  void start(const Merit& first) {
    most_violation_ = 1e4 * std::max(1.0, first.violation);
    small_violation_ = 1e-4 * std::max(1.0, first.violation);
  }
  void clear() { entries_.clear(); }
  // The point that trial points are compared with; slope is the derivative of the barrier function along the step.
  struct Reference {
    Merit here;
    double slope;
  };
  void look_from(const Reference& reference) {
    here_ = reference.here;
    slope_ = reference.slope;
  }
  void look_from(const Merit& here, double slope) { look_from({here, slope}); }
  Reference looking_from() const { return {here_, slope_}; }

  bool accepts(const Merit& trial, double alpha) const {
    if (!std::isfinite(trial.violation) || !std::isfinite(trial.barrier) || trial.violation > most_violation_)
      return false;
    const bool better = descends(alpha) && here_.violation <= small_violation_
                            ? falls_enough(trial, alpha)
                            : at_most(trial.violation, sufficient_violation(), here_.violation) ||
                                  at_most(trial.barrier, sufficient_barrier(), here_.barrier);
    return better && std::all_of(entries_.begin(), entries_.end(), [&](const Merit& e) {
             return at_most(trial.violation, e.violation, e.violation) || at_most(trial.barrier, e.barrier, e.barrier);
           });
  }

  // To be called when the search moves on to an accepted trial point. Unless the barrier function has decreased enough,
  // the point left behind enters the filter, so that the search cannot return to it.
  void leave(const Merit& trial, double alpha) {
    if (!descends(alpha) || !falls_enough(trial, alpha)) leave_for_good();
  }
  void leave_for_good() { entries_.push_back({sufficient_violation(), sufficient_barrier()}); }

  // Returns the step length below which only a restoration phase could help (equation 23).
  double shortest_step() const {
    double shortest = kGammaViolation;
    if (slope_ < 0) {
      shortest = std::min(shortest, kGammaBarrier * here_.violation / -slope_);
      if (here_.violation <= small_violation_) {
        shortest = std::min(shortest, std::pow(here_.violation, kViolationPower) / std::pow(-slope_, kBarrierPower));
      }
    }
    return kSafety * shortest;
  }

 private:
  static constexpr double kGammaViolation = 1e-5, kGammaBarrier = 1e-8, kArmijo = 1e-8, kViolationPower = 1.1,
                          kBarrierPower = 2.3, kSafety = 0.05;

  // Returns whether a <= b up to the rounding error of numbers of that size.
  static bool at_most(double a, double b, double size) {
    return a - b <= 10 * std::numeric_limits<double>::epsilon() * std::abs(size);
  }
  double sufficient_violation() const { return (1 - kGammaViolation) * here_.violation; }
  double sufficient_barrier() const { return here_.barrier - kGammaBarrier * here_.violation; }
  // The switching condition (19) and the Armijo condition (20).
  bool descends(double alpha) const {
    return slope_ < 0 && alpha * std::pow(-slope_, kBarrierPower) > std::pow(here_.violation, kViolationPower);
  }
  bool falls_enough(const Merit& trial, double alpha) const {
    return at_most(trial.barrier, here_.barrier + kArmijo * alpha * slope_, here_.barrier);
  }

  std::vector<Merit> entries_;
  double most_violation_ = 0, small_violation_ = 0, slope_ = 0;
  Merit here_{0, 0};
};

}  // namespace fjr
