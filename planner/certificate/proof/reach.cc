#include "planner/certificate/proof/reach.h"

#include <algorithm>
#include <cmath>

namespace fjr {
namespace {

using enclosure::Ball;
using enclosure::Polynomial;
using enclosure::rounded_up;

constexpr double kResolution = 1e-6;  // resolution of the largest value, as a fraction of the size
constexpr double kNegligible = 1e-8;  // fraction of the size: smaller last terms are added to the width of the first
constexpr int kMostHalvings = 40;

// sum_(k >= first) |c_k| t^k
double size(const Polynomial& c, std::size_t first, double t) {
  double sum = 0;
  for (std::size_t k = c.size(); k-- > first;) sum = rounded_up(sum * t + c[k].magnitude());
  for (std::size_t k = 0; k < first; ++k) sum = rounded_up(sum * t);
  return sum;
}

// Returns an upper bound of value + spread, spread >= 0.
double above(double value, double spread) { return Ball(value, spread).upper(); }

}  // namespace

Reach Reach::of_values(double allowed, double size) {
  Reach reach(allowed);
  reach.size_ = size;
  reach.bound_ = reach.found_ = -HUGE_VAL;
  reach.is_signed_ = true;
  return reach;
}

// |c(t)| <= |c_0| + sum |c_k| t^k, and c(t) <= c_0 + that sum.
bool Reach::is_below(const Polynomial& c, double length) const {
  return above(most(c[0]), size(c, 1, length)) <= bound_;
}

bool Reach::include(const Polynomial& c, const Ball& length, double time) {
  const double t = length.upper();
  if (is_below(c, t)) return true;
  Polynomial shorter = c;
  while (shorter.size() > 1) {
    double last = shorter.back().magnitude();
    for (std::size_t k = 1; k < shorter.size(); ++k) last = rounded_up(last * t);
    if (!(last <= kNegligible * size_)) break;
    shorter.pop_back();
    shorter[0] += Ball(0, last);
  }
  found_ = std::max({found_, least(c[0]), least(polynomial(shorter, shorter.size(), t))});
  return refine(shorter, t, time, 0);
}

// Divides the time into halves and bounds c from the middle of each: |c(m + s)| <= |c(m)| + sum |c^(k)(m) / k!| (length
// / 2)^k.
bool Reach::refine(const Polynomial& c, double length, double time, int depth) {
  if (is_below(c, length)) return true;
  const double half = rounded_up(length / 2);
  const Polynomial middle = enclosure::shifted(c, half);
  const double spread = size(middle, 1, half);
  const double upper = above(most(middle[0]), spread), lower = least(middle[0]);
  if (upper <= bound_) return true;
  found_ = std::max(found_, lower);
  // Halving reduces the spread, but not the uncertainty of the coefficients.
  const bool sharp = spread <= middle[0].rad || (upper <= allowed_ && upper <= found_ + kResolution * size_);
  if (sharp || lower > allowed_ || depth >= kMostHalvings || !std::isfinite(upper)) return take(upper, time + half);
  const auto first = [&] { return refine(c, half, time, depth + 1); };
  const auto second = [&] { return refine(middle, half, time + half, depth + 1); };
  // The half towards which the value grows comes first: its maximum often makes refining the other half needless.
  const bool rises = middle.size() > 1 && (is_signed_ ? 1 : middle[0].mid) * middle[1].mid > 0;
  return rises ? second() && first() : first() && second();
}

bool Reach::take(double upper, double time) {
  bound_ = std::isfinite(upper) ? upper : HUGE_VAL;
  time_ = time;
  return bound_ <= allowed_;
}

}  // namespace fjr
